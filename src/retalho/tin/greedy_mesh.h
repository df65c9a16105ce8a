// The triangulation that the grid refinement works on: records in a sparse array, cavities instead of flips.
//
// Ids need no counter: every quarter tile of the grid owns a range of two ids a cell, and an insertion takes the next
// ids of its cell's quarter. So ids, and with them every list and the output, do not depend on threads or timing, and
// records lie by place. The array is address space only; pages are committed as they are touched.
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/tin/greedy_scan.h"

namespace retalho::greedy {

/// A square of cells.
struct Square {
  int x0, y0, side;
  bool holds(Cell c) const {
    return static_cast<unsigned>(column_of(c) - x0) < static_cast<unsigned>(side) &&
           static_cast<unsigned>(row_of(c) - y0) < static_cast<unsigned>(side);
  }
};

/// Room for one insertion; kept by each worker. A cavity has a handful of triangles as a rule, but the first ones in
/// the middle of a large grid with rough sides may have a good part of all those along the sides: the room grows.
struct Cavity {
  static constexpr std::size_t kFirstRoom = 64;
  std::vector<Cell> ring = std::vector<Cell>(kFirstRoom);  // the boundary in order: edge i from ring[i] to ring[i + 1]
  std::vector<std::uint32_t> outside = std::vector<std::uint32_t>(kFirstRoom);  // the link across it
  std::vector<std::uint32_t> removed = std::vector<std::uint32_t>(kFirstRoom);
  std::vector<std::uint32_t> made = std::vector<std::uint32_t>(kFirstRoom);
  std::vector<std::uint32_t> stack = std::vector<std::uint32_t>(kFirstRoom);
  int ring_size = 0, removed_size = 0, made_size = 0;
  int opening = -1;  // ring edge that the new vertex lies on: a border edge

  int room() const { return static_cast<int>(stack.size()); }
  void grow();
};

struct TooManyCells {};  // for 30 bits of id; thrown by Mesh

class Mesh {
 public:
  /// `hull`: corners of the convex hull, area2 > 0 around; `quarter`: cells a side of a quarter tile.
  Mesh(int columns, int rows, int quarter, const std::vector<Cell>& hull);
  ~Mesh();
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;

  Record& operator[](std::uint32_t id) { return records_[id]; }
  const Record& operator[](std::uint32_t id) const { return records_[id]; }

  /// Opens the cavity of `p`, a cell in triangle `t`, in `cavity`. False, with nothing changed, when a corner of it
  /// lies outside of `within` (nullptr: the whole grid).
  bool open(std::uint32_t t, Cell p, const Square* within, Cavity& cavity) const;
  /// Fills it with the star of `p`; cavity.made are the new triangles, not yet scanned.
  void fill(Cell p, Cavity& cavity);

  std::size_t triangle_count() const;
  /// Blocks of ids in use, in the order of the output: [first, last) of each.
  std::size_t block_count() const { return used_.size() + 1; }
  void block(std::size_t index, std::uint32_t& first, std::uint32_t& last) const;

 private:
  template <class Wide>
  bool open_as(std::uint32_t t, Cell p, const Square* within, Cavity& cavity) const;
  void make_delaunay(std::uint32_t count);

  Record* records_ = nullptr;
  std::size_t bytes_ = 0;
  int quarter_, quarters_across_;
  std::uint32_t first_quarter_ = 0, ids_a_quarter_ = 0, initial_ = 0;
  std::vector<std::uint32_t> used_;  // ids in use of each quarter
  bool wide_;
};

}  // namespace retalho::greedy
