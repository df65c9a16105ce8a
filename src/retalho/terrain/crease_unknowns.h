// What a fit solves for on a surface with creases (terrain/creases.h): a height a vertex and a gradient a sector. Along
// a crease both sides take the mean of their slopes, so a triangle beside one depends on the gradients across it too;
// still it is a function of 9 numbers, those of its corners as they come out, and these are a linear function of the
// unknowns: u = P x. Elements and their matrix stay as they are without creases. Internal to terrain/.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/terrain/fit_system.h"

namespace retalho {

class CreasedUnknowns {
 public:
  /// `sectors`: crease_sectors of the mesh; `points`: its vertices, in the unit of the fit.
  CreasedUnknowns(TriangleList triangles, TriangleList neighbors, TriangleList sectors, std::span<const Vec2> points);

  /// Sectors at vertices. Node v < vertices is a vertex and its first sector; later ones have no height of their own.
  std::size_t nodes() const { return vertex_.size(); }
  std::size_t vertices() const { return vertices_; }
  std::uint32_t vertex(std::uint32_t node) const { return vertex_[node]; }

  /// The triangles by their corners' numbers: the node's where a corner has no crease, else one of its own.
  TriangleList triangles() const { return triangles_; }
  std::size_t corners() const { return corners_.size(); }

  /// u = P x and x = P'u, three numbers a corner and a node.
  void expand(const std::vector<double>& x, std::vector<double>& u, const Context& context) const;
  void gather(const std::vector<double>& u, std::vector<double>& x, const Context& context) const;
  /// The diagonal blocks of P'AP, 3 x 3 a node.
  std::vector<std::array<double, 9>> diagonal(std::span<const FitElement> elements) const;
  /// What comes out at a triangle's corners.
  CornerData at(std::uint32_t triangle, std::span<const Vec3> data) const;

 private:
  struct Corner {
    std::uint32_t vertex = kNone;
    std::array<std::uint32_t, 3> node{kNone, kNone, kNone};  ///< its own sector, and those across its two edges
    std::array<std::array<double, 4>, 3> share{};            ///< of each node's gradient: 2 x 2
  };
  void add_corner(TriangleList neighbors, TriangleList sectors, TriangleList triangles, std::span<const Vec2> points,
                  std::uint32_t triangle, std::size_t k);
  void list_corners();

  std::size_t vertices_;
  std::vector<std::uint32_t> vertex_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Corner> corners_;
  /// Corners that a vertex's height goes to, and (corner, which of its nodes) that a node's gradient goes to.
  std::vector<std::uint32_t> height_begin_, height_, gradient_begin_;
  std::vector<std::array<std::uint32_t, 2>> gradient_;
};

}  // namespace retalho
