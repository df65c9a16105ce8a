#include "retalho/patch/patch.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "retalho/patch/topology.h"

namespace retalho {
namespace {

Vec3 area_vector(const Patch& patch, std::size_t t) {
  const auto& [a, b, c] = patch.domain.triangles[t];
  return cross(patch.positions[b] - patch.positions[a], patch.positions[c] - patch.positions[a]);
}

bool is_regular(const Domain& domain) {
  const std::size_t n = domain.sides[0].size() - 1;
  return domain.sides[1].size() == n + 1 && domain.sides[2].size() == n + 1 &&
         domain.parameters.size() == (n + 1) * (n + 2) / 2 && domain.triangles.size() == n * n;
}

/// Thickness over size under which the patch is a plane one.
constexpr double kFlat = 1e-9;

bool is_plane(const Patch& patch, Vec3 normal, Vec3 origin, double size) {
  return std::all_of(patch.positions.begin(), patch.positions.end(),
                     [&](Vec3 p) { return std::abs(dot(p - origin, normal)) <= kFlat * size; });
}

}  // namespace

const char* recovery_name(Recovery recovery) {
  constexpr std::array<const char*, 3> names = {"barycentric", "spr", "smooth"};
  return names[static_cast<std::size_t>(recovery)];
}

Patch make_patch(const PatchSides& sides, const PatchOptions& options, const Context& context) {
  Patch patch;
  patch.domain = make_domain(options.divisions, options.layout, context);
  patch.recovery = options.recovery;
  patch.positions.resize(patch.domain.parameters.size());
  move_sides(patch, sides);
  return patch;
}

void move_sides(Patch& patch, const PatchSides& sides) {
  patch.sides = sides;
  const Domain& domain = patch.domain;
  if (is_regular(domain) && domain.parameters == regular_domain(domain.sides[0].size() - 1).parameters) {
    patch.positions = transfinite_grid(sides, domain.sides[0].size() - 1);
    return;
  }
  for (std::size_t i = 0; i < domain.parameters.size(); ++i)
    patch.positions[i] = transfinite_point(sides, domain.parameters[i]);
  for (std::size_t side = 0; side < 3; ++side) {
    const auto& nodes = domain.sides[side];
    for (std::size_t k = 0; k < nodes.size(); ++k) patch.positions[nodes[k]] = sides[side].node(k, nodes.size() - 1);
  }
}

FoldReport find_folds(const Patch& patch) {
  FoldReport report;
  const auto& triangles = patch.domain.triangles;
  double worst = 0;
  const auto note = [&](double how_much, const std::array<std::uint32_t, 3>& t) {
    ++report.folds;
    if (how_much <= worst && report.folds > 1) return;
    worst = how_much;
    report.parameters =
        (patch.domain.parameters[t[0]] + patch.domain.parameters[t[1]] + patch.domain.parameters[t[2]]) / 3;
    report.point = (patch.positions[t[0]] + patch.positions[t[1]] + patch.positions[t[2]]) / 3;
  };
  Vec3 total;
  for (std::size_t t = 0; t < triangles.size(); ++t) total = total + area_vector(patch, t);
  const double size = control_size(patch.positions);
  if (norm(total) > 0 && is_plane(patch, normalized(total), patch.positions[0], size)) {
    const Vec3 normal = normalized(total);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (const double area = dot(area_vector(patch, t), normal); !(area > 0)) note(-area, triangles[t]);
    return report;
  }
  const auto neighbors = triangle_neighbors(triangles);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t other : neighbors[t]) {
      if (other == kNoTriangle || other < t) continue;
      const Vec3 a = area_vector(patch, t), b = area_vector(patch, other);
      const double lengths = norm(a) * norm(b);
      if (!(lengths > 0) || dot(a, b) < 0) note(lengths > 0 ? -dot(a, b) / lengths : 0, triangles[t]);
    }
  return report;
}

}  // namespace retalho
