// CGAL's Poisson reconstruction and exact distances to triangles, for bench_tetraquad. CGAL stands in the .cpp only: it
// takes a minute to compile.
#pragma once

#include <memory>

#include "retalho/cloud/cloud.h"
#include "retalho/mesh/mesh.h"

namespace retalho::bench {

/// poisson_surface_reconstruction_delaunay with its own defaults and the points' average spacing (6 neighbours);
/// `fineness` divides the spacing that the surface mesher is told.
TriangleMesh poisson_by_cgal(const PointCloud& cloud, double fineness);

class MeshDistance {
 public:
  explicit MeshDistance(const TriangleMesh& mesh);
  ~MeshDistance();
  struct Foot {
    Vec3 point;
    Vec3 normal;  ///< of the nearest triangle, unit
  };
  Foot foot(Vec3 p) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace retalho::bench
