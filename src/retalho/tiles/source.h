// A tiled model's tiles one after the other, for work that reads each of them and never holds them all: level lines
// (level/tile_lines.h), meshes (mesh/tile_mesh.h); and tiled models as what others sample.
#pragma once

#include <cstddef>
#include <string>

#include "retalho/mesh/globe_mesh.h"
#include "retalho/model/tiled.h"
#include "retalho/terrain/tile_source.h"
#include "retalho/tiles/reader.h"

namespace retalho {

/// `bound`: bytes of the tiles that may be held at a time, with what work makes of them (kWorkedVertex bytes a vertex);
/// one may be held whatever its size. Reads the index alone; `load` throws CannotRead for a tile that is missing or
/// damaged. Throws CannotRead.
TileSource tile_source(const std::string& folder, std::size_t bound = TileReader::kBound);

/// Bytes a vertex of a tile that is worked on: surface, edges, traced points.
inline constexpr std::size_t kWorkedVertex = 1500;

/// A tiled model on the globe (mesh/globe_mesh.h); `box`: of its vertices. Refers to the reader.
GlobeSurface globe_surface(TileReader& reader, const VertexBox& box);

}  // namespace retalho
