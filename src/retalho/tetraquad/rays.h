// Rays against a TetraQuad surface, exact on the cubic: along a ray the function is one cubic polynomial in each
// tetrahedron, whose first root is the hit (docs/tetraquad.md). a tree of
// boxes, eight a node, finds the tetrahedra (ray_tree.h).
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>

#include "retalho/core/context.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

class TetraQuadRays {
 public:
  /// The field must outlive it. Tetrahedra that the surface does not touch are left out; the boxes of the others are
  /// drawn tight by `halvings` bisections (0: the tetrahedra's own). Cost: 0.02 ms a tetrahedron, 250 bytes.
  explicit TetraQuadRays(const TetraQuadField& field, int halvings = 9, const Context& context = {});
  ~TetraQuadRays();
  TetraQuadRays(TetraQuadRays&&) noexcept;
  TetraQuadRays& operator=(TetraQuadRays&&) noexcept;

  struct Hit {
    double t = 0;  ///< the point is origin + t * direction
    std::size_t tet = 0;
    TetBarycentric b{};
  };
  /// The first point of the surface on origin + t * direction, from <= t <= to. The direction need not be unit; a zero
  /// or non-finite ray hits nothing. Promises: no ray slips through between tetrahedra; t to 1e-9 of the grid's step
  /// where the ray crosses the surface at more than a grazing angle. The same bytes on machines with and without AVX2.
  /// Thread-safe. Cost: about 0.1 us.
  std::optional<Hit> first(Vec3 origin, Vec3 direction, double from = 0,
                           double to = std::numeric_limits<double>::infinity()) const;

  std::size_t size() const;  ///< tetrahedra in the tree

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Smallest root in [0, 1] of the cubic with these Bernstein coefficients, 0 counting as positive; -1: no change of
/// sign. By Descartes' rule, cuts at the derivative's roots, and Newton's steps kept in their bracket.
double first_root(const std::array<double, 4>& b);

}  // namespace retalho
