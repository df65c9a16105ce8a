// Internal to level/: fewer vertices, the topology kept (docs/contours.md, "Simplification").
//
// A chord may stand for a stretch of a line when the surface grows across the whole strip that holds the stretch: then
// each line across the strip meets the level once, so no other part of this level and no vertex of it lies there; and
// when the chord stays within its level's tube, so that it cannot meet another level's. No search for neighbours.
#pragma once

#include "retalho/core/context.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/raw_lines.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// Thins the vertices of `lines`; every line stays within lines.set.tolerance of its level set.
void simplify_lines(RawLines& lines, const FixedGrid& grid, const FixedLevels& levels, const Context& context);
/// `part`: the surface goes on beyond the terrain's border, unseen; no chord may come near it.
void simplify_lines(RawLines& lines, const Terrain& terrain, const EdgeTable& edges, double per_unit,
                    const FixedLevels& levels, const Context& context, bool part = false);

}  // namespace retalho
