// A Delaunay triangulation of grid cells that can be edited: vertices inserted at any cell, moved and removed. The
// convex outline stays as it is.
//
// Exact integer predicates; of four vertices on one circle the diagonal is the one at the first of them in raster
// order, so that the triangulation depends on the set of its vertices alone, not on the edits that led to it. Triangles
// and vertices are numbered without gaps: a removal moves the last of each into the free number. Triangles that an edit
// made, changed or renumbered are collected in changed().
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/tin/grid_cell.h"
#include "retalho/tin/tin.h"

namespace retalho {

class CellMesh {
 public:
  using Cell = greedy::Cell;

  /// The corners of a convex outline as vertices, in the order that hull_of_valid (grid_hull.h) gives them: area2 > 0
  /// around, no three on one line.
  explicit CellMesh(std::vector<Cell> outline);

  std::size_t vertex_count() const { return cells_.size(); }
  std::size_t triangle_count() const { return triangles_.size(); }
  const std::vector<Cell>& cells() const { return cells_; }
  Cell cell(std::uint32_t vertex) const { return cells_[vertex]; }
  /// (column, -row)
  Vec2 at(std::uint32_t vertex) const {
    return {static_cast<double>(greedy::column_of(cells_[vertex])),
            -static_cast<double>(greedy::row_of(cells_[vertex]))};
  }
  /// Counter-clockwise seen from above; triangle across the edge opposite corner k, kNone: border.
  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  const std::vector<std::array<std::uint32_t, 3>>& neighbors() const { return neighbors_; }
  /// A triangle at a vertex.
  std::uint32_t triangle_at(std::uint32_t vertex) const { return triangle_at_[vertex]; }
  /// Is the vertex on the outline?
  bool on_border(std::uint32_t vertex) const;

  /// The star of a vertex: its triangles counter-clockwise, and the vertices around it (one more than triangles on the
  /// border, where both start at the outline).
  struct Star {
    std::vector<std::uint32_t> triangles, ring;
    bool closed = true;
  };
  void star(std::uint32_t vertex, Star& star) const;

  /// The triangle that holds `p`, walking from triangle `from`; kNone: outside.
  std::uint32_t locate(Cell p, std::uint32_t from) const;
  /// A new vertex at `p`; kNone, and nothing done, where a vertex is already or outside of the outline.
  std::uint32_t insert(Cell p, std::uint32_t from);
  /// False, and nothing done, for a corner of the outline. Else the last vertex takes the number `vertex`.
  bool remove(std::uint32_t vertex);
  /// May the vertex move there with all its triangles staying counter-clockwise and the outline as it is?
  bool can_move(std::uint32_t vertex, Cell to) const;
  /// Moves it without flips: call restore() after the last one. `can_move` must hold.
  void displace(std::uint32_t vertex, Cell to);
  /// Flips until the triangulation is the canonical Delaunay one again.
  void restore();

  /// Triangles to be looked at again since the last clear_changed(), ascending.
  std::vector<std::uint32_t> changed() const;
  bool is_changed(std::uint32_t triangle) const { return changed_[triangle] != 0; }
  void clear_changed();

 private:
  std::uint32_t add_triangle(std::array<std::uint32_t, 3> corners, std::array<std::uint32_t, 3> links);
  void set_triangle(std::uint32_t t, std::array<std::uint32_t, 3> corners, std::array<std::uint32_t, 3> links);
  void drop_triangle(std::uint32_t t);
  void relink(std::uint32_t t, std::uint32_t from, std::uint32_t to);
  void flip(std::uint32_t t, std::uint32_t k);
  bool wants_flip(std::uint32_t t, std::uint32_t k) const;
  void legalise(std::vector<std::uint32_t>& stack);
  void split(std::uint32_t t, std::uint32_t vertex);
  void split_edge(std::uint32_t t, std::uint32_t k, std::uint32_t vertex);
  void restore(std::vector<std::uint32_t> stack);
  void fill_polygon(std::vector<std::uint32_t> ring, std::vector<std::uint32_t> outside,
                    const std::vector<std::uint32_t>& slots);

  std::vector<Cell> cells_;
  std::vector<std::uint32_t> triangle_at_;
  std::vector<std::array<std::uint32_t, 3>> triangles_, neighbors_;
  std::vector<std::uint8_t> changed_;
};

}  // namespace retalho
