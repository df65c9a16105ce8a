// The comparison of recoveries and parameters that docs/triangular-patches.md shows: errors, orders, gaps, jumps.
// Shared by the benchmark, which prints it, and the tests.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <string>

#include "patch/surfaces.h"
#include "retalho/patch/parameterize.h"
#include "retalho/patch/surface.h"

namespace retalho::test {

inline Vec2 random_place(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double a = unit(random), b = unit(random);
  return a + b > 1 ? Vec2{1 - a, 1 - b} : Vec2{a, b};
}

/// Largest distance of surface and curves on the sides.
inline double side_gap(const Patch& patch, const PatchSurface& surface) {
  double worst = 0;
  for (int side = 0; side < 3; ++side)
    for (int k = 0; k <= 1000; ++k)
      worst = std::max(worst, norm(surface.point(side_parameters(side, k / 1000.0)) -
                                   patch.sides[static_cast<std::size_t>(side)].point(k / 1000.0)));
  return worst;
}

/// The largest difference of one-sided gradients over all inner edges, at a few places of each.
inline double gradient_jump(const Patch& patch, const PatchSurface& surface) {
  double worst = 0;
  const double e = 1e-13;  // far enough to be in the other triangle, near enough for the limit
  for (const auto& t : patch.domain.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 a = patch.domain.parameters[t[k]], b = patch.domain.parameters[t[(k + 1) % 3]],
                 c = patch.domain.parameters[t[(k + 2) % 3]];
      for (const double s : {0.2, 0.5, 0.7}) {
        const Vec2 m = a + s * (b - a), in = (c - m) / norm(c - m);
        const Vec2 p = m + e * in, q = m - e * in;
        if (q.x < 0 || q.y < 0 || q.x + q.y > 1) continue;
        const SurfaceJet x = surface.jet(p), y = surface.jet(q);
        worst = std::max({worst, norm(x.du - y.du), norm(x.dv - y.dv)});
      }
    }
  return worst;
}

struct Measured {
  double error = 0;               ///< largest |S - X| at 6000 points
  double gradient = 0;            ///< largest difference of a first derivative
  double gap = 0, jump = 0;       ///< on the sides; across edges
  double making = 0, asking = 0;  ///< s to make the surface; ns for value and derivatives at a random point
};

inline Measured measure(const Surface& truth, Domain domain, Recovery recovery) {
  const Patch patch = natural_patch(truth, std::move(domain), recovery);
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto seconds = [](auto a, auto b) { return std::chrono::duration<double>(b - a).count(); };
  const auto start = now();
  const PatchSurface surface(patch, {.threads = 1});
  Measured m;
  m.making = seconds(start, now());
  std::mt19937_64 random(3);
  std::vector<Vec2> places;
  places.reserve(6000);
  for (int k = 0; k < 6000; ++k) places.push_back(random_place(random));
  std::vector<SurfaceJet> jets(places.size());
  m.asking = 1e300;
  for (int run = 0; run < 9; ++run) {
    const auto asked = now();
    for (std::size_t k = 0; k < places.size(); ++k) jets[k] = surface.jet(places[k]);
    m.asking = std::min(m.asking, 1e9 * seconds(asked, now()) / static_cast<double>(places.size()));
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    const SurfaceJet x = truth(places[k]);
    m.error = std::max(m.error, norm(jets[k].point - x.point));
    m.gradient = std::max({m.gradient, norm(jets[k].du - x.du), norm(jets[k].dv - x.dv)});
  }
  m.gap = side_gap(patch, surface);
  m.jump = gradient_jump(patch, surface);
  return m;
}

/// The octant by its shape alone: distance from the sphere and angle of the normal, whatever the parameters.
struct Shape {
  double distance = 0, degrees = 0;
};
inline Shape sphere_shape(const Patch& patch) {
  const PatchSurface surface(patch, {.threads = 1});
  std::mt19937_64 random(3);
  Shape shape;
  for (int k = 0; k < 6000; ++k) {
    const PatchJet jet = surface.full_jet(random_place(random));
    shape.distance = std::max(shape.distance, std::abs(norm(jet.point) - 1));
    const Vec3 out = normalized(jet.point);
    const double turn = std::atan2(norm(cross(jet.normal, out)), std::abs(dot(jet.normal, out)));
    shape.degrees = std::max(shape.degrees, turn * 180 / 3.14159265358979323846);
  }
  return shape;
}

inline Patch octant_with_parameters(Domain domain, Weights weights, Recovery recovery) {
  std::vector<Vec3> positions;
  for (const Vec2& p : domain.parameters) positions.push_back(octant(p).point);
  const std::array<std::uint32_t, 3> corners = {domain.sides[0][0], domain.sides[1][0], domain.sides[2][0]};
  return patch_of(parameterize(positions, domain.triangles, {.weights = weights, .corners = corners}), recovery);
}

inline std::string comparison_tables() {
  const std::array<std::pair<const char*, Surface>, 4> surfaces = {
      {{"octant", octant}, {"sine", sine}, {"monkey saddle", monkey}, {"rational cubic", rational}}};
  std::string text =
      "| surface, mesh | recovery | error, n = 64 | order | gradient's error | gap at the sides | jump of the gradient "
      "| "
      "making, ms | a point, ns |\n| --- | --- | --: | --: | --: | --: | --: | --: | --: |\n";
  for (const auto& [name, truth] : surfaces)
    for (const bool regular : {true, false})
      for (const Recovery recovery : {Recovery::barycentric, Recovery::spr, Recovery::smooth}) {
        const auto domain = [&](std::size_t n) { return regular ? regular_domain(n) : irregular_domain(n, 1); };
        const Measured coarse = measure(truth, domain(32), recovery), fine = measure(truth, domain(64), recovery);
        const std::string order =
            fine.error < 1e-11 ? std::string("exact") : fmt::format("{:.1f}", std::log2(coarse.error / fine.error));
        text += fmt::format("| {}, {} | {} | {:.1e} | {} | {:.1e} | {:.1e} | {:.1e} | {:.1f} | {:.0f} |\n", name,
                            regular ? "regular" : "irregular", recovery_name(recovery), fine.error, order,
                            fine.gradient, fine.gap, fine.jump, 1e3 * fine.making, fine.asking);
      }
  text +=
      "\n| octant, n = 64: mesh, parameters | barycentric: distance / normal | spr | smooth |\n| --- | --: | --: | --: "
      "|\n";
  for (const bool regular : {true, false})
    for (const int parameters : {0, 1, 2}) {
      constexpr std::array<const char*, 3> names = {"natural", "shape-preserving", "mean value"};
      text += fmt::format("| {}, {} |", regular ? "regular" : "irregular", names[static_cast<std::size_t>(parameters)]);
      for (const Recovery recovery : {Recovery::barycentric, Recovery::spr, Recovery::smooth}) {
        const Domain domain = regular ? regular_domain(64) : irregular_domain(64, 1);
        const Shape shape = sphere_shape(
            parameters == 0 ? natural_patch(octant, domain, recovery)
                            : octant_with_parameters(
                                  domain, parameters == 1 ? Weights::shape_preserving : Weights::mean_value, recovery));
        text += fmt::format(" {:.1e} / {:.3g} deg |", shape.distance, shape.degrees);
      }
      text += "\n";
    }
  return text;
}

}  // namespace retalho::test
