// Internal to level/: the polynomial pieces of one triangle of a terrain surface, in whole quanta.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "retalho/level/frame.h"
#include "retalho/level/piece_topology.h"
#include "retalho/level/triangle_patch.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// The pieces of one triangle as doubled quanta.
template <SurfaceKind Kind>
struct FixedPieces {
  using Topology = PieceTopology<Kind>;
  using Patch = TrianglePatch<Topology::kDegree>;

  std::array<typename Patch::template Net<double>, Topology::kPieces> nets;
  std::array<Frame, Topology::kPieces> frames;
  double low = 0, high = 0;

  FixedPieces(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle, double per_unit) {
    std::array<TerrainPatch, 6> pieces;
    triangle_patches(terrain, edges, triangle, pieces);
    for (std::size_t p = 0; p < Topology::kPieces; ++p) {
      const auto& corner = pieces[p].corners;
      frames[p] = {corner[2], corner[0] - corner[2], corner[1] - corner[2]};
      for (std::size_t i = 0; i < nets[p].size(); ++i)
        nets[p][i] = 2 * std::nearbyint(pieces[p].ordinates[i] * per_unit);
      const auto [a, b] = std::minmax_element(nets[p].begin(), nets[p].end());
      low = p == 0 ? *a : std::min(low, *a);
      high = p == 0 ? *b : std::max(high, *b);
    }
  }
};

}  // namespace retalho
