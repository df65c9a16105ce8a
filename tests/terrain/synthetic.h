// Triangulations and height functions for the tests: none of it comes from the code under test.
#pragma once

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "retalho/terrain/fit.h"
#include "retalho/tin/tin.h"

namespace retalho::test {

using HeightFunction = std::function<double(Vec2)>;

inline double franke(Vec2 p) {
  const auto q = [](double a) { return a * a; };
  return .75 * std::exp(-(q(9 * p.x - 2) + q(9 * p.y - 2)) / 4) +
         .75 * std::exp(-q(9 * p.x + 1) / 49 - (9 * p.y + 1) / 10) +
         .5 * std::exp(-(q(9 * p.x - 7) + q(9 * p.y - 3)) / 4) - .2 * std::exp(-q(9 * p.x - 4) - q(9 * p.y - 7));
}

/// Delaunay triangulation of the points, by CGAL.
inline Tin delaunay(const std::vector<Vec2>& points, const HeightFunction& height) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
  using Triangulation = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase>>;
  std::vector<std::pair<Kernel::Point_2, std::uint32_t>> numbered;
  for (std::uint32_t k = 0; k < points.size(); ++k) numbered.emplace_back(Kernel::Point_2(points[k].x, points[k].y), k);
  const Triangulation triangulation(numbered.begin(), numbered.end());
  Tin tin;
  tin.points = points;
  for (const Vec2 p : points) tin.heights.push_back(height(p));
  for (auto f = triangulation.finite_faces_begin(); f != triangulation.finite_faces_end(); ++f)
    tin.triangles.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  build_neighbors(tin);
  return tin;
}

/// n random points in the unit square and its four corners.
inline std::vector<Vec2> random_points(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec2> points{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  while (points.size() < n + 4) points.push_back({unit(random), unit(random)});
  return points;
}

/// n random points of the unit square, of which 4 sqrt(n) lie on its border, corners among them: without points on the
/// border the triangulation there is nothing but slivers as long as the square.
inline std::vector<Vec2> random_points_with_border(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec2> points{{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  const auto border = static_cast<std::size_t>(4 * std::sqrt(static_cast<double>(n)));
  while (points.size() < border) {
    const double at = unit(random);
    const std::size_t side = points.size() % 4;
    points.push_back(side == 0 ? Vec2{at, 0} : side == 1 ? Vec2{at, 1} : side == 2 ? Vec2{0, at} : Vec2{1, at});
  }
  while (points.size() < n) points.push_back({unit(random), unit(random)});
  return points;
}

/// side x side points of the unit square, the inner ones moved by up to 0.3 of the spacing: no slivers.
inline std::vector<Vec2> jittered_points(int side, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> move(-0.3, 0.3);
  std::vector<Vec2> points;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const bool border = i == 0 || j == 0 || i == side - 1 || j == side - 1;
      const double dx = border ? 0 : move(random), dy = border ? 0 : move(random);
      points.push_back({(i + dx) / (side - 1), (j + dy) / (side - 1)});
    }
  return points;
}

/// Central differences of a smooth function, good to about 1e-9.
inline Vec2 gradient_of(const HeightFunction& f, Vec2 p) {
  const double h = 1e-5;
  return {(f({p.x + h, p.y}) - f({p.x - h, p.y})) / (2 * h), (f({p.x, p.y + h}) - f({p.x, p.y - h})) / (2 * h)};
}

/// Value and gradient of a piece at a point.
inline Jet jet_of(const TerrainPatch& patch, Vec2 p) {
  const TriangleFrame frame(patch.corners[0], patch.corners[1], patch.corners[2]);
  const Barycentric u = frame.barycentric(p);
  if (patch.degree == 2) {
    TriangleNet<2> net;
    std::copy_n(patch.ordinates.begin(), net.size(), net.begin());
    return evaluate_jet<2>(net, frame, u);
  }
  TriangleNet<3> net;
  std::copy_n(patch.ordinates.begin(), net.size(), net.begin());
  return evaluate_jet<3>(net, frame, u);
}

}  // namespace retalho::test
