// CGAL's Delaunay triangulation as the slow twin: where no four points lie on an empty circle, there is one answer.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "retalho/tin/scattered.h"
#include "support/support.h"

namespace retalho {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertices>>;

TEST(TriangulatePoints, AgreesWithCgal) {
  test::Random random;
  for (const double far : {0.0, 5e6}) {
    std::vector<Vec3> points(30000);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double spread = k % 10 == 0 ? 1000.0 : 1.0;
      points[k] = {far + random.uniform(0, spread), far + random.uniform(0, spread), random.uniform()};
    }
    const Tin tin = triangulate_points(points);
    Delaunay twin;
    for (std::uint32_t k = 0; k < tin.points.size(); ++k)
      twin.insert(Kernel::Point_2(tin.points[k].x, tin.points[k].y))->info() = k;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const auto& face : twin.finite_face_handles()) {
      std::array<std::uint32_t, 3> v{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
      std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
      triangles.push_back(v);
    }
    std::sort(triangles.begin(), triangles.end());
    ASSERT_EQ(tin.triangles, triangles);
  }
}

}  // namespace
}  // namespace retalho
