#include "retalho/patch/parameterize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/curve/interpolate.h"
#include "retalho/patch/mesh_rings.h"
#include "retalho/patch/multigrid.h"
#include "retalho/patch/weights.h"

namespace retalho {
namespace {

constexpr std::size_t kDirect = 2000;  ///< unknowns up to which the direct solver is as fast
constexpr std::uint32_t kInner = 0xffffffffU;

/// The border cut at the corners: sides from corner to corner, ends included.
std::array<std::vector<std::uint32_t>, 3> cut_border(const std::vector<std::uint32_t>& border,
                                                     const std::array<std::uint32_t, 3>& corners) {
  std::array<std::size_t, 3> at{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = std::find(border.begin(), border.end(), corners[i]);
    if (found == border.end() || corners[i] == corners[(i + 1) % 3])
      throw BadInput(fmt::format("corner {} is not a vertex of the border, or is named twice: three vertices of the "
                                 "border are needed, of which it has {}",
                                 corners[i], border.size()),
                     {}, fmt::format("vertex {}", corners[i]));
    at[i] = static_cast<std::size_t>(found - border.begin());
  }
  const std::size_t n = border.size();
  if ((at[1] + n - at[0]) % n > (at[2] + n - at[0]) % n) std::swap(at[1], at[2]);
  std::array<std::vector<std::uint32_t>, 3> sides;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = at[i];; k = (k + 1) % n) {
      sides[i].push_back(border[k]);
      if (k == at[(i + 1) % 3]) break;
    }
  return sides;
}

/// Splits every inner edge whose ends are on one side. Returns how many.
std::size_t split_dividing(std::vector<Vec3>& positions, std::vector<Triangle>& triangles,
                           const std::array<std::vector<std::uint32_t>, 3>& sides) {
  // Which sides a vertex is on, and its place there.
  std::vector<std::array<std::uint32_t, 3>> place(positions.size(), {kInner, kInner, kInner});
  std::vector<std::uint8_t> on(positions.size(), 0);
  for (std::size_t s = 0; s < 3; ++s)
    for (std::uint32_t k = 0; k < sides[s].size(); ++k) {
      place[sides[s][k]][s] = k;
      on[sides[s][k]] = 1;
    }
  const auto dividing = [&](std::uint32_t a, std::uint32_t b) {
    if (a >= on.size() || b >= on.size() || on[a] == 0 || on[b] == 0) return false;
    for (std::size_t s = 0; s < 3; ++s) {
      const std::uint32_t i = place[a][s], j = place[b][s];
      if (i != kInner && j != kInner && i + 1 != j && j + 1 != i) return true;
    }
    return false;
  };
  std::size_t count = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(positions.size()));
    if (fresh) {
      positions.push_back(0.5 * (positions[a] + positions[b]));
      ++count;
    }
    return at->second;
  };
  for (std::size_t t = 0; t < triangles.size(); ++t)  // halves come at the end and are looked at in their turn
    for (std::size_t k = 0; k < 3; ++k) {
      const Triangle c = triangles[t];
      const std::uint32_t a = c[(k + 1) % 3], b = c[(k + 2) % 3];
      if (!dividing(a, b)) continue;
      const std::uint32_t m = middle(a, b);
      triangles[t] = {c[k], a, m};
      triangles.push_back({c[k], m, b});
      k = static_cast<std::size_t>(-1);  // the changed triangle again, from its first edge
    }
  return count;
}

void place_sides(Domain& domain, const std::vector<Vec3>& positions) {
  for (std::size_t s = 0; s < 3; ++s) {
    const auto& nodes = domain.sides[s];
    double total = 0, sum = 0;
    for (std::size_t k = 1; k < nodes.size(); ++k) total += norm(positions[nodes[k]] - positions[nodes[k - 1]]);
    domain.parameters[nodes[0]] = side_parameters(static_cast<int>(s), 0);
    for (std::size_t k = 1; k + 1 < nodes.size(); ++k) {
      sum += norm(positions[nodes[k]] - positions[nodes[k - 1]]);
      domain.parameters[nodes[k]] = side_parameters(static_cast<int>(s), sum / total);
    }
  }
}

/// Inner vertices breadth-first from the border, so that neighbours stand near each other whatever the mesh's order.
std::vector<std::uint32_t> solving_order(const MeshRings& rings, const std::vector<std::uint32_t>& border) {
  std::vector<std::uint8_t> seen(rings.border.size(), 0);
  std::vector<std::uint32_t> queue = border;
  queue.reserve(rings.border.size());
  for (const std::uint32_t v : border) seen[v] = 1;
  for (std::size_t i = 0; i < queue.size(); ++i)
    for (const std::uint32_t w : rings.of(queue[i]))
      if (seen[w] == 0) {
        seen[w] = 1;
        queue.push_back(w);
      }
  queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(border.size()));
  return queue;
}

struct System {
  ConvexSystem matrix;
  std::vector<Vec2> right;
};

System assemble(const MeshRings& rings, const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& order,
                const std::vector<Vec2>& parameters, Weights kind) {
  std::vector<std::uint32_t> number(positions.size(), kInner);
  for (std::uint32_t i = 0; i < order.size(); ++i) number[order[i]] = i;
  System system;
  system.right.assign(order.size(), {});
  system.matrix.first.reserve(order.size() + 1);
  system.matrix.columns.reserve(6 * order.size());
  system.matrix.values.reserve(6 * order.size());
  NeighborWeights weights;
  std::vector<double> lambda;
  std::vector<Vec3> around;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto ring = rings.of(order[i]);
    around.clear();
    for (const std::uint32_t w : ring) around.push_back(positions[w]);
    weights.compute(positions[order[i]], around, kind, lambda);
    for (std::size_t k = 0; k < ring.size(); ++k) {
      if (number[ring[k]] == kInner) {
        system.right[i] = system.right[i] + lambda[k] * parameters[ring[k]];
      } else {
        system.matrix.columns.push_back(number[ring[k]]);
        system.matrix.values.push_back(lambda[k]);
      }
    }
    system.matrix.first.push_back(static_cast<std::uint32_t>(system.matrix.columns.size()));
  }
  return system;
}

/// A triangle that is turned over or has no area, or kInner.
std::uint32_t first_flip(const Domain& domain) {
  for (std::uint32_t t = 0; t < domain.triangles.size(); ++t) {
    const auto& [i, j, k] = domain.triangles[t];
    const Vec2 a = domain.parameters[i], b = domain.parameters[j], c = domain.parameters[k];
    if (!(cross(b - a, c - a) > 0)) return t;
  }
  return kInner;
}

}  // namespace

std::vector<std::uint32_t> check_disk(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  return disk_border(mesh_rings(positions, triangles), positions, triangles.size());
}

std::array<std::uint32_t, 3> find_corners(std::span<const Vec3> positions, std::span<const std::uint32_t> border) {
  const std::size_t n = border.size();
  std::vector<std::pair<double, std::size_t>> turns;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 in = positions[border[k]] - positions[border[(k + n - 1) % n]],
               out = positions[border[(k + 1) % n]] - positions[border[k]];
    turns.emplace_back(-std::atan2(norm(cross(in, out)), dot(in, out)), k);
  }
  std::partial_sort(turns.begin(), turns.begin() + 3, turns.end());
  std::array<std::size_t, 3> at = {turns[0].second, turns[1].second, turns[2].second};
  std::sort(at.begin(), at.end());
  std::array<std::uint32_t, 3> corners = {border[at[0]], border[at[1]], border[at[2]]};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

Parameterization parameterize(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                              const ParameterizeOptions& options, const Context& context) {
  context.report("parameters", 0);
  Parameterization out;
  out.positions.assign(positions.begin(), positions.end());
  out.domain.triangles.assign(triangles.begin(), triangles.end());
  MeshRings rings = mesh_rings(positions, triangles);
  const auto border = disk_border(rings, positions, triangles.size());
  out.domain.sides = cut_border(border, options.corners ? *options.corners : find_corners(positions, border));
  out.split_edges = split_dividing(out.positions, out.domain.triangles, out.domain.sides);
  if (out.split_edges > 0) rings = mesh_rings(out.positions, out.domain.triangles);
  out.domain.parameters.assign(out.positions.size(), {});
  place_sides(out.domain, out.positions);
  context.check();
  context.report("parameters", 0.2);

  const auto order = solving_order(rings, border);
  std::vector<Vec2> solution;
  const auto place = [&] {
    for (std::size_t i = 0; i < order.size(); ++i) out.domain.parameters[order[i]] = solution[i];
  };
  const System system = assemble(rings, out.positions, order, out.domain.parameters, options.weights);
  rings = {};
  context.report("parameters", 0.4);
  if (order.size() <= kDirect)
    solve_direct(system.matrix, system.right, solution);
  else
    out.iterations = solve_iterative(system.matrix, system.right, solution, context);
  place();
  std::uint32_t flip = first_flip(out.domain);
  if (flip != kInner && out.iterations > 0) {
    solve_direct(system.matrix, system.right, solution);
    out.iterations = 0;
    place();
    flip = first_flip(out.domain);
  }
  if (flip != kInner) {
    const Vec3 p = out.positions[out.domain.triangles[flip][0]];
    throw BadInput(
        fmt::format("the parameters about ({:.6g}, {:.6g}, {:.6g}) (triangle {}) come closer than doubles can "
                    "tell apart: the mesh stands there on a thin neck, or has needles; cut it, or remesh it",
                    p.x, p.y, p.z, flip),
        {}, fmt::format("triangle {}", flip));
  }
  context.report("parameters", 1);
  return out;
}

Patch patch_of(Parameterization parameterization, Recovery recovery) {
  Patch patch;
  patch.recovery = recovery;
  patch.domain = std::move(parameterization.domain);
  patch.positions = std::move(parameterization.positions);
  for (std::size_t s = 0; s < 3; ++s) {
    const auto& nodes = patch.domain.sides[s];
    std::vector<double> at(nodes.size()), value(nodes.size());
    std::array<std::vector<double>, 3> slopes;
    for (std::size_t k = 0; k < nodes.size(); ++k)
      at[k] = side_argument(static_cast<int>(s), patch.domain.parameters[nodes[k]]);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const Vec3 p = patch.positions[nodes[k]];
        value[k] = c == 0 ? p.x : c == 1 ? p.y : p.z;
      }
      slopes[c] = spline_slopes(at, value);
    }
    Curve curve;
    curve.dimension = 3;
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
      const Vec3 a = patch.positions[nodes[k]], b = patch.positions[nodes[k + 1]];
      const double third = (at[k + 1] - at[k]) / 3;
      curve.append(std::vector<Vec3>{a, a + third * Vec3{slopes[0][k], slopes[1][k], slopes[2][k]},
                                     b - third * Vec3{slopes[0][k + 1], slopes[1][k + 1], slopes[2][k + 1]}, b});
    }
    curve.breaks = at;
    patch.sides[s] = SideCurve(std::move(curve));
  }
  return patch;
}

}  // namespace retalho
