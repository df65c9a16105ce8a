// Triangular patches: user CPU time and accuracy of parameters, recovery, point location and a dragged side, beside
// CGAL's mean value parameterization in the same run. `--value NAME` prints one figure as JSON (the names are listed
// without it); `--comparison` prints the tables of docs/triangular-patches.md.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/Circular_border_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Mean_value_coordinates_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <cstring>
#include <functional>
#include <map>

#include "patch/comparison.h"
#include "retalho/patch/parameterize.h"

namespace {

using namespace retalho;
using namespace retalho::test;

double user_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}
double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

double best_of(int runs, const std::function<void()>& body) {
  double best = 1e300;
  for (int run = 0; run < runs; ++run) {
    const double start = user_seconds();
    body();
    best = std::min(best, user_seconds() - start);
  }
  return best;
}

const Context kOne{.threads = 1};

/// An irregular mesh of the octant with n^2 triangles or so, without parameters.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
Mesh octant_mesh(std::size_t n) {
  Domain domain = irregular_domain(n, 1);
  Mesh mesh;
  for (const Vec2& p : domain.parameters) mesh.positions.push_back(octant(p).point);
  mesh.triangles = std::move(domain.triangles);
  return mesh;
}

double our_parameters(const Mesh& mesh, int runs, Weights weights = Weights::mean_value) {
  return best_of(runs, [&] { parameterize(mesh.positions, mesh.triangles, {.weights = weights}, kOne); });
}

double cgal_parameters(const Mesh& mesh, int runs) {
  namespace smp = CGAL::Surface_mesh_parameterization;
  using Surface_mesh = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;
  Surface_mesh surface;
  for (const Vec3& p : mesh.positions) surface.add_vertex({p.x, p.y, p.z});
  using Index = Surface_mesh::Vertex_index;
  for (const auto& t : mesh.triangles) surface.add_face(Index(t[0]), Index(t[1]), Index(t[2]));
  Surface_mesh::Halfedge_index border;
  for (const auto h : surface.halfedges())
    if (surface.is_border(h)) border = h;
  auto uv = surface.add_property_map<Index, CGAL::Simple_cartesian<double>::Point_2>("h:uv").first;
  using Border = smp::Circular_border_arc_length_parameterizer_3<Surface_mesh>;
  return best_of(runs, [&] {
    const auto error =
        smp::parameterize(surface, smp::Mean_value_coordinates_parameterizer_3<Surface_mesh, Border>(), border, uv);
    if (error != smp::OK) std::fprintf(stderr, "CGAL: %s\n", smp::get_error_message(error));
  });
}

volatile double sink;

/// Nanoseconds of value and both derivatives at a random point.
double evaluation(std::size_t n) {
  const PatchSurface surface(natural_patch(octant, regular_domain(n), Recovery::smooth), kOne);
  std::mt19937_64 random(1);
  std::vector<Vec2> places;
  places.reserve(1000000);
  for (int k = 0; k < 1000000; ++k) places.push_back(random_place(random));
  return 1e9 / static_cast<double>(places.size()) * best_of(5, [&] {
           Vec3 sum;
           for (const Vec2& p : places) {
             const SurfaceJet jet = surface.jet(p);
             sum = sum + jet.point + jet.du + jet.dv;
           }
           sink = sum.x + sum.y + sum.z;
         });
}

double dragging() {
  const auto sides = [](double height) {
    return PatchSides{
        SideCurve(make_bezier(std::vector<Vec3>{{1, 0, 0}, {0.8, 0.3, height}, {0.2, 0.9, 0.2}, {0, 1, 0}}, 3, 3)),
        SideCurve(make_bezier(std::vector<Vec3>{{0, 1, 0}, {0, 0.6, 0.4}, {0, 0.3, 0.1}, {0, 0, 0}}, 3, 3)),
        SideCurve(make_bezier(std::vector<Vec3>{{0, 0, 0}, {0.4, 0, 0.3}, {0.6, 0, 0.1}, {1, 0, 0}}, 3, 3))};
  };
  Patch patch = make_patch(sides(0), {.divisions = {64, 64, 64}});
  PatchSurface surface(patch, kOne);
  double height = 0;
  return 1e3 / 20 * best_of(5, [&] {
           for (int k = 0; k < 20; ++k) {
             move_sides(patch, sides(height += 0.01));
             surface.move(patch, kOne);
           }
           sink = surface.point({0.3, 0.3}).x;
         });
}

const std::map<std::string, std::function<double()>>& values() {
  static const std::map<std::string, std::function<double()>> all = {
      {"parameters-1m", [] { return our_parameters(octant_mesh(1000), 2); }},
      {"parameters-1m-shape", [] { return our_parameters(octant_mesh(1000), 2, Weights::shape_preserving); }},
      {"parameters-1m-memory",
       [] {
         our_parameters(octant_mesh(1000), 1);
         return peak_megabytes();
       }},
      {"parameters-100k", [] { return our_parameters(octant_mesh(316), 5); }},
      {"parameters-100k-shape", [] { return our_parameters(octant_mesh(316), 5, Weights::shape_preserving); }},
      {"parameters-100k-cgal",
       [] {
         const Mesh mesh = octant_mesh(316);
         return our_parameters(mesh, 5) / cgal_parameters(mesh, 2);
       }},
      {"parameters-1m-cgal",
       [] {
         const Mesh mesh = octant_mesh(1000);
         return our_parameters(mesh, 1) / cgal_parameters(mesh, 1);
       }},
      {"cgal-100k", [] { return cgal_parameters(octant_mesh(316), 2); }},
      {"octant", [] { return measure(octant, regular_domain(64), Recovery::smooth).error; }},
      {"octant-order",
       [] {
         return std::log2(measure(octant, regular_domain(32), Recovery::smooth).error /
                          measure(octant, regular_domain(64), Recovery::smooth).error);
       }},
      {"sine", [] { return measure(sine, regular_domain(64), Recovery::smooth).error; }},
      {"sine-order",
       [] {
         return std::log2(measure(sine, regular_domain(32), Recovery::smooth).error /
                          measure(sine, regular_domain(64), Recovery::smooth).error);
       }},
      {"octant-irregular", [] { return measure(octant, irregular_domain(64, 1), Recovery::smooth).error; }},
      {"gap", [] { return measure(sine, regular_domain(64), Recovery::smooth).gap / 2; }},
      {"jump", [] { return measure(octant, irregular_domain(64, 1), Recovery::smooth).jump; }},
      {"evaluation-100k", [] { return evaluation(316); }},
      {"evaluation-4k", [] { return evaluation(64); }},
      {"locator-1m",
       [] {
         const Domain domain = regular_domain(1000);
         return best_of(3, [&] { sink = DomainLocator(domain).locate({0.3, 0.3}).l1; });
       }},
      {"drag-64", dragging},
  };
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "--comparison") == 0) {
    std::fputs(comparison_tables().c_str(), stdout);
    return 0;
  }
  if (argc == 3 && std::strcmp(argv[1], "--value") == 0 && values().contains(argv[2])) {
    fmt::print("{{\"value\": {:.6g}}}\n", values().at(argv[2])());
    return 0;
  }
  if (argc > 1) {
    fmt::print(stderr, "usage: bench_patch [--comparison | --value NAME]\n");
    return 2;
  }
  for (const auto& [name, value] : values()) fmt::print("{:24} {:.4g}\n", name, value());
}
