// A Delaunay triangulation that grows point by point: cavities in flat arrays, exact predicates. Internal to tin/.
//
// The outside is made of "ghost" triangles with the vertex kGhost, one behind each edge of the hull, so that a point
// outside is inserted as any other. A point in conflict with a triangle lies strictly inside its circle (for a ghost:
// strictly outside the hull's edge, or on it between its ends); the conflicting triangles are a polygon without inner
// vertices, star-shaped around the new point (Bowyer 1981, Watson 1981), which is why no marks are needed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/core/vec.h"
#include "retalho/tin/tin.h"

namespace retalho {

class ScatteredMesh {
 public:
  static constexpr std::uint32_t kGhost = kNone;

  struct Triangle {
    std::array<std::uint32_t, 3> v;  // counter-clockwise; at most one is kGhost
    std::array<std::uint32_t, 3> n;  // across the edge opposite v[k]; always a triangle
  };

  /// Starts with one triangle of three places that are not on one line. `at` must outlive the mesh.
  ScatteredMesh(const std::vector<Vec2>& at, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::size_t expected);

  /// Inserts place `p`, which is not a vertex yet; the search starts at triangle `hint`. Returns a new triangle.
  std::uint32_t insert(std::uint32_t p, std::uint32_t hint);

  /// The triangle that holds `q` (on its border counts); a ghost in conflict with q when q lies outside the hull.
  std::uint32_t locate(Vec2 q, std::uint32_t hint) const;

  const std::vector<Triangle>& triangles() const { return triangles_; }
  bool is_ghost(std::uint32_t t) const {
    const auto& v = triangles_[t].v;
    return v[0] == kGhost || v[1] == kGhost || v[2] == kGhost;
  }

  /// The triangles that the last insertion wrote, in order around the new point; the first `removed()` of them had
  /// been the cavity's, and were overwritten.
  const std::vector<std::uint32_t>& star() const { return star_; }
  std::size_t removed() const { return removed_; }

 private:
  struct BorderEdge {
    std::uint32_t from, to, outside, slot;  // outside: the triangle behind it, and which of its edges it is
  };

  bool in_conflict(std::uint32_t t, Vec2 q) const;
  void collect(std::uint32_t first, Vec2 q);

  const std::vector<Vec2>& at_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> star_;                    // scratch: cavity, then the new star
  std::vector<BorderEdge> border_;                     // scratch
  std::vector<std::array<std::uint32_t, 2>> pending_;  // scratch: triangle, edge still to be looked at
  std::size_t removed_ = 0;
};

struct Places;

/// The mesh's triangles without ghosts in canonical order (scattered.h). `vertex` gives the number of each place
/// (kNone: not a vertex), `vertices` how many there are; empty: every place is the vertex of its own number.
Tin to_tin(const ScatteredMesh& mesh, const Places& places, const std::vector<std::uint32_t>& vertex,
           std::size_t vertices);

}  // namespace retalho
