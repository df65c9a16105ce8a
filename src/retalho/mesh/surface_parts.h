// The parts of a surface that nothing joins, and leaving some of them out: noise and holes make small ones that belong
// to nobody's shape (docs/tetraquad.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "retalho/cloud/cloud.h"
#include "retalho/mesh/mesh.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// Triangles that hang together by their vertices.
struct SurfacePart {
  std::size_t triangles = 0;
  std::size_t points = 0;  ///< near it: their foot lies on it, no further away than its tetrahedron is large
  double area = 0;
  Vec3 low, high;  ///< its box
};

struct SurfaceParts {
  std::vector<SurfacePart> parts;          ///< the most points first; of equal ones the larger area
  std::vector<std::uint32_t> of_triangle;  ///< the part of each triangle of the mesh
};

/// `mesh`: of `field` (mesh_tetraquad). Points that are not finite, or whose foot no triangle is near, count for no
/// part; where there is one part only they are not looked at, and all count for it. The same result from any number of
/// threads. Cost: 0.3 us a triangle, and with several parts 2 us a point.
SurfaceParts find_parts(const TriangleMesh& mesh, const TetraQuadField& field, const PointCloud& points,
                        const Context& context = {});

/// Which parts are wanted: the `most` with the most points, and of them those with at least `points` near them.
struct PartChoice {
  std::size_t most = std::numeric_limits<std::size_t>::max();  ///< 1 or more
  std::size_t points = 0;
};
/// One mark a part. Throws UsageError where no part is left.
std::vector<char> choose_parts(const SurfaceParts& found, const PartChoice& choice);

/// The triangles of the parts that are marked (`keep`: one mark a part) and their vertices, in their order.
TriangleMesh keep_parts(const TriangleMesh& mesh, const SurfaceParts& parts, const std::vector<char>& keep);

/// Marks the field's tetrahedra that only parts which are not marked pass through, for without_tetrahedra. A part that
/// shares a tetrahedron with one that stays must stay too: it gets its mark in `keep`.
std::vector<char> tetrahedra_left_out(const TriangleMesh& mesh, const TetraQuadField& field, const SurfaceParts& parts,
                                      std::vector<char>& keep);

}  // namespace retalho
