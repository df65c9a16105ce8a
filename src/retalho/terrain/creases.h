// Creases: edges of a TIN that a smooth surface folds along. Heights are continuous across a crease, gradients are not;
// everywhere else the surface stays as smooth as its kind.
//
// The creases at a vertex part its triangles into sectors, and each sector has a gradient of its own: the vertex's
// number names that of the sector with the lowest triangle, further ones stand behind the vertices', by vertex, then by
// lowest triangle. Along a crease both sides take the mean of their two derivatives at each end, so that they meet in
// the same curve, to the last bit. Where the sides of a bent crease cannot agree about the slope along it, the first
// edge beside it folds too, near that vertex, by as much as they differ. A vertex where one crease ends has one sector:
// there the crease fades out.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// Which gradient each corner of each triangle has; `nodes`, if asked for, gets how many there are (at least one a
/// vertex). Border edges among `creases` part nothing. Cost: a few ns a corner.
std::vector<std::array<std::uint32_t, 3>> crease_sectors(const Tin& tin, const EdgeTable& edges,
                                                         std::span<const std::uint32_t> creases,
                                                         std::size_t* nodes = nullptr);

/// The vertex of each gradient number.
std::vector<std::uint32_t> sector_vertices(const Tin& tin, std::span<const std::array<std::uint32_t, 3>> sectors,
                                           std::size_t nodes);

/// One gradient a sector, estimated from the sector's side alone as if the TIN ended at the creases; where two creases
/// go straight on through a vertex (by less than 60 degrees), all sectors get the slope along them that the parabola
/// through the three heights has. Kinds as estimate_gradients.
std::vector<Vec2> sector_gradients(const Tin& tin, const EdgeTable& edges, std::span<const std::uint32_t> creases,
                                   std::span<const std::array<std::uint32_t, 3>> sectors, GradientKind kind,
                                   const Context& context = {});

}  // namespace retalho
