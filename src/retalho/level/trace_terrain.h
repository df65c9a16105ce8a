// Internal to level/: tracing the pieces of a terrain surface on a triangulation.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/trace.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// Quanta a height unit: a power of two that keeps every doubled ordinate below 2^29.
double terrain_quanta(const Terrain& terrain, const EdgeTable& edges, const Context& context);

/// The roots on the edges of the triangulation: those of half h of edge e are roots[start[halves * e + h] ...], from
/// the edge's lower-index end to the other. They are the first points of the trace.
struct OuterRoots {
  int halves = 1;
  std::vector<std::uint32_t> start;
  std::vector<EdgeRoot> roots;
};

/// Ordinates are rounded one by one, so neighbours see the same integers on a shared edge. Trace::cell holds the
/// triangle of each point. The order of points depends on the terrain alone. `conics`: of a Powell-Sabin surface, arcs
/// are left whole, and Trace::conics holds them; the tolerance is not used then.
Trace trace_terrain(const Terrain& terrain, const EdgeTable& edges, double per_unit, const FixedLevels& levels,
                    double tolerance, OuterRoots& outer, const Context& context, bool conics = false);

}  // namespace retalho
