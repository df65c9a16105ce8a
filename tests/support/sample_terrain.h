// Small terrain models built by hand, for tests of what uses them: their numbers are random, their form is right.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "retalho/terrain/terrain.h"

namespace retalho::test {

struct SampleOptions {
  SurfaceKind kind = SurfaceKind::clough_tocher;
  CrossDerivative cross_derivative = CrossDerivative::perpendicular;
  int columns = 5, rows = 4;  ///< vertices of the lattice
  bool on_grid = true;        ///< vertices at cell centres of a grid three times as fine; else jittered
  bool integer_heights = true;
  bool mask = false;  ///< with a mask that has holes
  double drop = 0;    ///< share of triangles left out: holes and bays
  double cell_width = 1, cell_height = 1;
  bool shuffled = false;  ///< triangles in random order, each starting at a random corner
  std::uint64_t seed = 1;
};

/// A lattice cut into triangles along random diagonals.
inline Terrain sample_terrain(const SampleOptions& o) {
  std::mt19937_64 random(o.seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Terrain t;
  t.kind = o.kind;
  t.cross_derivative = o.cross_derivative;
  t.gradient_kind = o.kind == SurfaceKind::linear ? GradientKind::none : GradientKind::given;
  t.georef = {uniform(-1e6, 1e6), uniform(-1e6, 1e6), 1, 1, "LOCAL_CS[\"sample\"]", "metre", false};
  t.tolerance = uniform(0, 3);
  if (o.on_grid || o.mask) {
    t.grid = {o.columns * 3 - 2, o.rows * 3 - 2, o.cell_width, o.cell_height, {}};
    if (o.mask) {
      t.grid.valid = Mask(t.grid.columns, t.grid.rows, true);
      for (int k = 0; k < t.grid.columns * t.grid.rows / 9; ++k)
        t.grid.valid.set(static_cast<int>(random() % static_cast<std::uint64_t>(t.grid.columns)),
                         static_cast<int>(random() % static_cast<std::uint64_t>(t.grid.rows)), false);
    }
  }
  for (int r = 0; r < o.rows; ++r)
    for (int c = 0; c < o.columns; ++c) {
      const double x = 3 * c, y = -3 * r;
      t.tin.points.push_back(
          o.on_grid ? Vec2{x * o.cell_width, y * o.cell_height}
                    : Vec2{(x + uniform(-0.7, 0.7)) * o.cell_width, (y + uniform(-0.7, 0.7)) * o.cell_height});
      t.tin.heights.push_back(o.integer_heights ? std::floor(uniform(-100, 3000)) : uniform(-100, 3000));
    }
  for (int r = 0; r + 1 < o.rows; ++r)
    for (int c = 0; c + 1 < o.columns; ++c) {
      const auto nw = static_cast<std::uint32_t>(r * o.columns + c), ne = nw + 1;
      const std::uint32_t sw = nw + static_cast<std::uint32_t>(o.columns), se = sw + 1;
      const bool falling = (random() & 1) != 0;
      if (uniform(0, 1) >= o.drop) t.tin.triangles.push_back(falling ? std::array{nw, sw, se} : std::array{nw, sw, ne});
      if (uniform(0, 1) >= o.drop) t.tin.triangles.push_back(falling ? std::array{nw, se, ne} : std::array{ne, sw, se});
    }
  if (t.tin.triangles.empty()) t.tin.triangles.push_back({0, static_cast<std::uint32_t>(o.columns), 1});
  if (o.shuffled) {
    std::shuffle(t.tin.triangles.begin(), t.tin.triangles.end(), random);
    for (auto& v : t.tin.triangles)
      std::rotate(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(random() % 3), v.end());
  }
  build_neighbors(t.tin);
  const std::size_t edges = build_edges(t.tin).vertices.size();
  if (o.kind != SurfaceKind::linear)
    for (std::size_t i = 0; i < t.tin.points.size(); ++i) t.gradients.push_back({uniform(-50, 50), uniform(-50, 50)});
  if (o.kind == SurfaceKind::powell_sabin)
    for (std::size_t e = 0; e < edges; ++e) t.edge_split.push_back(uniform(0.01, 0.99));
  if (o.kind == SurfaceKind::clough_tocher && o.cross_derivative == CrossDerivative::cubic)
    for (std::size_t e = 0; e < edges; ++e) t.edge_fallback.push_back(static_cast<std::uint8_t>(random() & 1));
  return t;
}

}  // namespace retalho::test
