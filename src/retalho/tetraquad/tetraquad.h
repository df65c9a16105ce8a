// TetraQuad surfaces: the zero set of a continuous function that is a cubic in each tetrahedron, the linear blend of a
// quadric at each vertex (docs/tetraquad.md; source: the TetraQuad element, chapter 2).
//
//   C(p) = step * sum_i b_i(p) q_i(p)    over the four corners i, b_i the barycentric coordinates
//
// Quadrics are written about their own vertex and in steps of the grid, which keeps their numbers near 1 wherever the
// surface lies. Different quadrics can give the same function (a 20-dimensional choice for each face-connected part),
// so functions are compared by their Bernstein ordinates.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "retalho/bernstein/tetrahedron.h"
#include "retalho/raster/georef.h"
#include "retalho/tetraquad/tet_mesh.h"

namespace retalho {

/// Factors of 1, u, v, w, uu, vv, ww, uv, uw, vw, where (u, v, w) is the way from the vertex in steps of the grid.
using Quadric = std::array<double, 10>;

/// The quadric's polar form: symmetric, linear (affine) in each argument, q(u, u) is the value.
constexpr double polar(const Quadric& q, Vec3 u, Vec3 v) {
  return q[0] + (q[1] * (u.x + v.x) + q[2] * (u.y + v.y) + q[3] * (u.z + v.z)) / 2 + q[4] * u.x * v.x +
         q[5] * u.y * v.y + q[6] * u.z * v.z +
         (q[7] * (u.x * v.y + u.y * v.x) + q[8] * (u.x * v.z + u.z * v.x) + q[9] * (u.y * v.z + u.z * v.y)) / 2;
}

/// The same quadric seen from `d` further on.
Quadric shifted(const Quadric& q, Vec3 d);

/// The 20 Bernstein ordinates of sum b_i q_i: c_abc = (q_a[b,c] + q_b[c,a] + q_c[a,b]) / 3. `x`: the corners, in the
/// quadrics' unit. Those of a face use the face's corners only: neighbours agree on it.
TetCubic ordinates(const std::array<Quadric, 4>& q, const std::array<Vec3, 4>& x);

struct TetraQuad {
  TetMesh mesh;
  std::vector<Quadric> quadrics;  ///< one a vertex
  Georef georef;                  ///< of the points that it was made from
};

/// The ordinates of one tetrahedron, in steps of the grid.
TetCubic ordinates(const TetraQuad& surface, std::size_t tet);

/// A vertex's quadric of the quasi-interpolant, from the function's value, gradient and second derivatives there.
Quadric interpolating_quadric(const Jet3& jet, double step);

/// The local quasi-interpolant of a smooth function: the quadric of each vertex is f + (2/3) grad f . d +
/// (1/6) d' Hess f d. Every cubic is reproduced; the error of others falls with step^4.
TetraQuad quasi_interpolant(TetMesh mesh, const std::function<Jet3(Vec3)>& f);

/// What a vertex of a tetrahedron's neighbour gets when the function is continued across the face as the same cubic:
/// the four quadrics extrapolated linearly to the lattice point `at`, seen from there.
Quadric continued(const TetraQuad& surface, std::size_t tet, const LatticePoint& at);

/// A surface that is asked many questions: keeps the ordinates of all tetrahedra (160 bytes each). The TetraQuad must
/// outlive it.
class TetraQuadField {
 public:
  explicit TetraQuadField(const TetraQuad& surface);

  const TetraQuad& surface() const { return *surface_; }
  const TetCubic& ordinates(std::size_t tet) const { return ordinates_[tet]; }
  const TetFrame& frame(std::size_t tet) const { return frames_[tet]; }  ///< in lattice coordinates

  /// Value (a length: about the signed distance), gradient and Hessian at p; nothing outside of all tetrahedra.
  std::optional<Jet3> jet(Vec3 p) const;
  /// The same without a search, at barycentric coordinates of a tetrahedron.
  Jet3 jet(std::size_t tet, const TetBarycentric& b) const;
  Jet3 gradient(std::size_t tet, const TetBarycentric& b) const;  ///< value and gradient only

  struct Foot {
    Vec3 point;
    Vec3 normal;  ///< unit
  };
  /// The surface point that Newton's steps along the gradient lead to from p (at most `steps`, none longer than a step
  /// of the grid); nothing when they leave the tetrahedra or do not end within 1e-9 of the grid's step.
  std::optional<Foot> project(Vec3 p, int steps = 30) const;

  /// Can the surface pass through the tetrahedron? Its ordinates have both signs; false is proof that it does not.
  bool may_cross(std::size_t tet) const;
  /// Does it? The function changes its sign between the nodes of a lattice of six parts an edge; true is proof.
  bool crosses(std::size_t tet) const;

 private:
  const TetraQuad* surface_;
  std::vector<TetCubic> ordinates_;
  std::vector<TetFrame> frames_;
};

}  // namespace retalho
