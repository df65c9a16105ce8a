#include "retalho/patch/joins.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr int kPlaces = 64;

/// Do the two sides run along each other, the second one backwards or not?
bool same_course(const SideCurve& a, const SideCurve& b, bool backwards, double tolerance) {
  for (const int k : {0, 8, 4, 2, 6, 1, 3, 5, 7}) {
    const double s = k / 8.0;
    if (!(norm(a.point(s) - b.point(backwards ? 1 - s : s)) <= tolerance)) return false;
  }
  return true;
}

PatchJoin describe(std::span<const Patch> patches, std::span<const PatchSurface> surfaces, PatchJoin join,
                   bool backwards) {
  const auto side = [](int s) { return static_cast<std::size_t>(s); };
  const Patch &a = patches[join.first], &b = patches[join.second];
  std::vector<std::uint32_t> nodes_a = a.domain.sides[side(join.first_side)],
                             nodes_b = b.domain.sides[side(join.second_side)];
  if (backwards) std::reverse(nodes_b.begin(), nodes_b.end());
  join.watertight = nodes_a.size() == nodes_b.size();
  for (std::size_t k = 0; join.watertight && k < nodes_a.size(); ++k)
    join.watertight = a.positions[nodes_a[k]] == b.positions[nodes_b[k]];
  for (int k = 0; k <= kPlaces; ++k) {
    const double s = static_cast<double>(k) / kPlaces;
    const PatchJet x = surfaces[join.first].full_jet(side_parameters(join.first_side, s)),
                   y = surfaces[join.second].full_jet(side_parameters(join.second_side, backwards ? 1 - s : s));
    join.gap = std::max(join.gap, norm(x.point - y.point));
    const Vec3 other = backwards ? y.normal : -y.normal;  // sides that run the same way: the patches look two ways
    const double angle = std::atan2(norm(cross(x.normal, other)), dot(x.normal, other)) * 180 / std::numbers::pi;
    if (angle < join.degrees) continue;
    join.degrees = angle;
    join.at = s;
    join.point = x.point;
  }
  join.g1 = join.degrees <= 0.01;
  return join;
}

}  // namespace

std::vector<PatchJoin> find_joins(std::span<const Patch> patches, std::span<const PatchSurface> surfaces) {
  std::vector<PatchJoin> joins;
  double size = 0;
  for (const Patch& patch : patches) size = std::max(size, control_size(patch.positions));
  for (std::size_t i = 0; i < patches.size(); ++i)
    for (std::size_t j = i + 1; j < patches.size(); ++j)
      for (int s = 0; s < 3; ++s)
        for (int t = 0; t < 3; ++t)
          for (const bool backwards : {true, false}) {
            if (!same_course(patches[i].sides[static_cast<std::size_t>(s)],
                             patches[j].sides[static_cast<std::size_t>(t)], backwards, 1e-6 * size))
              continue;
            PatchJoin join;
            join.first = i, join.second = j, join.first_side = s, join.second_side = t;
            joins.push_back(describe(patches, surfaces, join, backwards));
          }
  return joins;
}

Patch refine(const Patch& patch, const PatchSurface& surface, std::size_t factor) {
  if (factor < 1) throw UsageError("a patch is refined by a factor of 1 at least");
  if (factor == 1) return patch;
  Patch fine;
  fine.name = patch.name;
  fine.sides = patch.sides;
  fine.recovery = patch.recovery;
  fine.domain.parameters = patch.domain.parameters;
  fine.positions = patch.positions;
  const auto f = static_cast<double>(factor);
  // Side edges first: their new nodes are the curves'. Where the nodes are evenly spaced they are node(k, n), which a
  // neighbour on the same curve computes in the same way.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges;
  for (std::size_t side = 0; side < 3; ++side) {
    const auto& nodes = patch.domain.sides[side];
    const std::size_t n = nodes.size() - 1;
    const auto argument = [&](std::size_t k) {
      return side_argument(static_cast<int>(side), patch.domain.parameters[nodes[k]]);
    };
    bool even = true;
    for (std::size_t k = 0; k <= n; ++k)
      even = even && std::abs(argument(k) - static_cast<double>(k) / static_cast<double>(n)) < 1e-9;
    auto& out = fine.domain.sides[side];
    for (std::size_t k = 0; k < n; ++k) {
      out.push_back(nodes[k]);
      std::vector<std::uint32_t> between;
      for (std::size_t m = 1; m < factor; ++m) {
        const double s = argument(k) + static_cast<double>(m) / f * (argument(k + 1) - argument(k));
        between.push_back(static_cast<std::uint32_t>(fine.positions.size()));
        fine.domain.parameters.push_back(side_parameters(static_cast<int>(side), s));
        fine.positions.push_back(even ? patch.sides[side].node(k * factor + m, n * factor)
                                      : patch.sides[side].point(s));
      }
      out.insert(out.end(), between.begin(), between.end());
      if (nodes[k] > nodes[k + 1]) std::reverse(between.begin(), between.end());
      edges[std::minmax(nodes[k], nodes[k + 1])] = std::move(between);
    }
    out.push_back(nodes[n]);
  }
  const auto add = [&](Vec2 uv) {
    fine.domain.parameters.push_back(uv);
    fine.positions.push_back(surface.point(uv));
    return static_cast<std::uint32_t>(fine.positions.size() - 1);
  };
  std::vector<std::uint32_t> net((factor + 1) * (factor + 2) / 2);
  const auto slot = [factor](std::size_t i, std::size_t j) { return i * (factor + 1) - i * (i + 1) / 2 + i + j; };
  for (const auto& t : patch.domain.triangles) {
    const std::array<Vec2, 3> p = {patch.domain.parameters[t[0]], patch.domain.parameters[t[1]],
                                   patch.domain.parameters[t[2]]};
    net[slot(0, 0)] = t[0];
    net[slot(factor, 0)] = t[1];
    net[slot(0, factor)] = t[2];
    const auto edge = [&](std::size_t a, std::size_t b, auto&& place) {
      const auto [at, fresh] = edges.try_emplace(std::minmax(t[a], t[b]));
      const bool turned = t[a] > t[b];
      if (fresh)
        for (std::size_t m = 1; m < factor; ++m) {
          const double s = static_cast<double>(m) / f;
          at->second.push_back(add(turned ? (1 - s) * p[b] + s * p[a] : (1 - s) * p[a] + s * p[b]));
        }
      for (std::size_t m = 1; m < factor; ++m) net[place(m)] = at->second[turned ? factor - 1 - m : m - 1];
    };
    edge(0, 1, [&](std::size_t m) { return slot(m, 0); });
    edge(0, 2, [&](std::size_t m) { return slot(0, m); });
    edge(1, 2, [&](std::size_t m) { return slot(factor - m, m); });
    for (std::size_t i = 1; i < factor; ++i)
      for (std::size_t j = 1; i + j < factor; ++j) {
        const double a = static_cast<double>(i) / f, b = static_cast<double>(j) / f;
        net[slot(i, j)] = add((1 - a - b) * p[0] + a * p[1] + b * p[2]);
      }
    for (std::size_t i = 0; i < factor; ++i)
      for (std::size_t j = 0; i + j < factor; ++j) {
        fine.domain.triangles.push_back({net[slot(i, j)], net[slot(i + 1, j)], net[slot(i, j + 1)]});
        if (i + j + 1 < factor)
          fine.domain.triangles.push_back({net[slot(i + 1, j)], net[slot(i + 1, j + 1)], net[slot(i, j + 1)]});
      }
  }
  return fine;
}

}  // namespace retalho
