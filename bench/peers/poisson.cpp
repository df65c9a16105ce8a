#include "poisson.h"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include <stdexcept>
#include <utility>
#include <vector>

namespace retalho::bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Oriented = std::pair<Point, Kernel::Vector_3>;
using Primitive = CGAL::AABB_face_graph_triangle_primitive<Mesh>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

}  // namespace

TriangleMesh poisson_by_cgal(const PointCloud& cloud, double fineness) {
  std::vector<Oriented> points;
  points.reserve(cloud.positions.size());
  for (std::size_t k = 0; k < cloud.positions.size(); ++k) {
    const Vec3 &p = cloud.positions[k], &n = cloud.normals[k];
    points.emplace_back(Point(p.x, p.y, p.z), Kernel::Vector_3(n.x, n.y, n.z));
  }
  const auto place = CGAL::First_of_pair_property_map<Oriented>();
  const double spacing =
      CGAL::compute_average_spacing<CGAL::Sequential_tag>(points, 6, CGAL::parameters::point_map(place));
  Mesh surface;
  if (!CGAL::poisson_surface_reconstruction_delaunay(points.begin(), points.end(), place,
                                                     CGAL::Second_of_pair_property_map<Oriented>(), surface,
                                                     spacing / fineness))
    throw std::runtime_error("CGAL's Poisson reconstruction failed");
  TriangleMesh mesh;
  for (const auto v : surface.vertices()) {
    const Point& p = surface.point(v);
    mesh.positions.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : surface.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t n = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      if (n < 3) corners[n++] = static_cast<std::uint32_t>(v);
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

struct MeshDistance::Parts {
  const TriangleMesh& mesh;
  Mesh surface;
  std::vector<std::uint32_t> number;  // of a face
  Tree tree;
};

MeshDistance::MeshDistance(const TriangleMesh& mesh) : parts_(new Parts{mesh, {}, {}, {}}) {
  std::vector<Mesh::Vertex_index> at;
  at.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {  // every triangle for itself: manifold or not
    std::array<Mesh::Vertex_index, 3> v;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p = mesh.positions[mesh.triangles[t][i]];
      v[i] = parts_->surface.add_vertex(Point(p.x, p.y, p.z));
    }
    parts_->surface.add_face(v[0], v[1], v[2]);
    parts_->number.push_back(t);
  }
  const auto [first, last] = faces(parts_->surface);
  parts_->tree.rebuild(first, last, parts_->surface);
  parts_->tree.accelerate_distance_queries();
}

MeshDistance::~MeshDistance() = default;

MeshDistance::Foot MeshDistance::foot(Vec3 p) const {
  const auto [point, face] = parts_->tree.closest_point_and_primitive(Point(p.x, p.y, p.z));
  const auto& t = parts_->mesh.triangles[parts_->number[face]];
  const auto& at = parts_->mesh.positions;
  const Vec3 normal = cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
  return {{point.x(), point.y(), point.z()}, norm2(normal) > 0 ? normalized(normal) : Vec3{}};
}

}  // namespace retalho::bench
