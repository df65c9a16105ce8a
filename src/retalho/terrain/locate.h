// Which triangle of a TIN holds a point: an exact-sign walk, started from a grid of hints.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/terrain/side.h"
#include "retalho/tin/tin.h"

namespace retalho {

using Corners = std::array<Vec2, 3>;

/// What a step of the walk needs to know of a triangle: one line of memory.
struct alignas(64) Facet {
  Corners corners;
  std::array<std::uint32_t, 3> neighbors;  ///< across the edge opposite corner k
};

/// Refers to the TIN, which must outlive it. Safe to use from several threads at once.
///
/// A triangle holds its border. Of the triangles that hold a point the one with the highest number owns it, so the
/// answer never depends on where the walk came from. Cost: two or three steps from the grid on a TIN of even density,
/// O(sqrt(n)) from a far hint. Where the outline is not convex, a point that the walk loses costs O(n).
class PointLocator {
 public:
  explicit PointLocator(const Tin& tin, const Context& context = {});

  /// A triangle near `p`; kNone: outside of the triangulation's box, or not a number.
  std::uint32_t hint(Vec2 p) const {
    if (!(p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y)) return kNone;
    const int c = std::min(columns_ - 1, static_cast<int>((p.x - low_.x) * per_x_));
    const int r = std::min(rows_ - 1, static_cast<int>((p.y - low_.y) * per_y_));
    return hints_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)];
  }

  /// kNone: outside, or not a number.
  std::uint32_t locate(Vec2 p, std::uint32_t hint = kNone) const;

  const Facet& facet(std::uint32_t triangle) const { return facets_[triangle]; }
  /// Does `p` lie inside the triangle, and not on its border? Exact.
  bool holds_inside(std::uint32_t triangle, Vec2 p) const {
    const Corners& c = facets_[triangle].corners;
    return side_of(c[0], c[1], p) > 0 && side_of(c[1], c[2], p) > 0 && side_of(c[2], c[0], p) > 0;
  }

 private:
  struct Step {
    std::uint32_t triangle;
    bool inside, on_edge;
  };
  /// Where the floating-point filter decides every step and `p` ends up off all edges: its triangle. Else kNone, and
  /// `from` is as near as it came.
  std::uint32_t quick_walk(Vec2 p, std::uint32_t& from) const;
  Step walk(Vec2 p, std::uint32_t from) const;
  std::uint32_t owner(Vec2 p, std::uint32_t triangle) const;
  std::uint32_t search_all(Vec2 p) const;
  bool outline_is_convex() const;

  const Tin& tin_;
  std::vector<Facet> facets_;
  Vec2 low_, high_;
  bool convex_ = false;
  int columns_ = 1, rows_ = 1;
  double per_x_ = 0, per_y_ = 0;      // grid cells a unit
  std::vector<std::uint32_t> hints_;  // a triangle near the centre of each grid cell
};

}  // namespace retalho
