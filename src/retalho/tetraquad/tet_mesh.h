// Tetrahedral meshes on a grid of cubes: the cells of a TetraQuad surface. Only the cubes near the surface hold any.
//
// The lattice of the cubes' corners has whole coordinates; a vertex lies at origin + step * lattice. Topology is
// decided by whole numbers only.
#pragma once

#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "retalho/bernstein/tetrahedron.h"
#include "retalho/core/vec.h"
#include "retalho/tetraquad/forest.h"
#include "retalho/tetraquad/half_faces.h"

namespace retalho {

using LatticePoint = std::array<std::int32_t, 3>;

/// How a cube is cut: `five` (a regular one in the middle and one at every other corner; neighbouring cubes alternate
/// by the parity of i + j + k, so that faces match), or `kuhn` (six round the long diagonal, every cube alike).
enum class TetSplit : std::uint8_t { five, kuhn };

/// A tetrahedron of the full grid: which cube, and which of its five or six.
struct TetPlace {
  LatticePoint cell{};
  std::uint8_t type = 0;
  friend bool operator==(const TetPlace&, const TetPlace&) = default;
  friend bool operator<(const TetPlace& a, const TetPlace& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.type < b.type;
  }
};

/// How many a cube has.
constexpr int tets_of_cube(TetSplit split) {
  return split == TetSplit::five ? 5 : 6;
}
/// The four lattice points of a tetrahedron; Kuhn's in path order (Maubach).
std::array<LatticePoint, 4> lattice_corners(TetSplit split, const TetPlace& place);
/// The tetrahedron on the other side of the face opposite to `corner`, in the full grid.
TetPlace across(TetSplit split, const TetPlace& place, int corner);

struct TetMesh {
  Vec3 origin;
  double step = 1;  ///< edge length of a cube
  TetSplit split = TetSplit::five;
  std::vector<LatticePoint> lattice;                               ///< of each vertex
  std::vector<TetCorners> tets;                                    ///< either orientation
  std::vector<TetPlace> places;                                    ///< of each tetrahedron, ascending
  std::unordered_map<std::uint64_t, std::uint32_t> first_in_cell;  ///< by cell_key: the cell's first tetrahedron
  /// Adaptive meshes: whose leaves the tetrahedra are, TetForest::kUnit steps to a root cube; `places` is empty then.
  std::shared_ptr<const TetForest> forest;
  std::unordered_map<std::uint32_t, std::uint32_t> tet_of_leaf;  ///< by the leaf's node

  Vec3 position(std::size_t vertex) const {
    const LatticePoint& l = lattice[vertex];
    return origin + step * Vec3{static_cast<double>(l[0]), static_cast<double>(l[1]), static_cast<double>(l[2])};
  }
  /// In lattice coordinates.
  Vec3 to_lattice(Vec3 p) const { return (p - origin) / step; }
  /// A tetrahedron's frame in lattice coordinates.
  TetFrame frame(std::size_t tet) const;
  /// The length in steps that the fit's terms are measured by: a cube's edge, or the cube root of six volumes.
  double size(std::size_t tet) const { return forest ? std::cbrt(std::abs(frame(tet).volume6)) : 1; }

  /// The tetrahedron that holds `p` and p's barycentric coordinates in it, or -1. On shared faces: the first.
  std::int64_t locate(Vec3 p, TetBarycentric* where = nullptr) const;
};

/// Throws BadInput when a cell lies 2^20 or more from the origin. `places` need not be sorted; doubles are dropped.
TetMesh make_tet_mesh(Vec3 origin, double step, TetSplit split, std::vector<TetPlace> places);

/// The adaptive mesh of these leaves.
TetMesh make_tet_mesh(Vec3 origin, double step, std::shared_ptr<const TetForest> forest,
                      const std::vector<std::uint32_t>& leaves);

/// The tetrahedron of the full grid that holds the point, in lattice coordinates.
TetPlace place_of(TetSplit split, Vec3 lattice_point);

std::uint64_t cell_key(const LatticePoint& cell);

/// The tetrahedra as a legacy VTK file (ASCII, unstructured grid; one scalar `data` a vertex where given). Atomic.
/// Throws CannotWrite, UsageError when `data` is neither empty nor one a vertex.
void write_vtk(const TetMesh& mesh, const std::vector<double>& data, const std::string& path, bool overwrite = false);

}  // namespace retalho
