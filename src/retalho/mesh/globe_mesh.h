// A terrain model as a folder of tiles for viewers of the globe: quantized-mesh 1.0, or 3D Tiles 1.1 with glTF.
//
// The model needs a CRS. Its heights are taken as they are; globes mean heights over the ellipsoid, and most grids give
// heights over the sea: add the geoid to the grid first where tens of metres matter.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/tile_source.h"

namespace retalho {

struct QuantizedMeshOptions {
  double tolerance = 0;  ///< height units, at the finest level, against the samples; twice as much a level above it; 0:
                         ///< a thousandth of the height range
  int level = -1;        ///< the finest; -1: whose samples are as fine as the model's cells
  double outside = 0;    ///< the height of what the model does not cover, as tiles have no holes
  bool normals = true;   ///< with the extension of oct-encoded normals
  bool gzip = true;      ///< as servers send them; Cesium takes both
};
/// What is asked of a surface that is sampled: one that comes tile by tile can answer, too.
struct GlobeSurface {
  Georef georef;
  Vec3 low, high;      ///< the box of its vertices, local coordinates
  double columns = 0;  ///< cells from west to east
  /// Height and gradient at local places, nullopt where there is no data. The same bits for the same place, whoever
  /// asks for it and with what others. Called from several threads at once.
  std::function<std::vector<std::optional<Jet>>(std::span<const Vec2>)> jets;
};
/// Refers to the model.
GlobeSurface globe_surface(const TerrainEvaluator& model);

struct GlobeNotes {
  std::size_t tiles = 0, triangles = 0, bytes = 0;
  int levels = 0;
  double step = 0;  ///< quantized mesh: of the heights
};

inline constexpr int kQuantizedMeshCells = 128;  ///< samples from edge to edge of a tile, before they are thinned

/// Quantized-mesh 1.0 (the specification of that name): {level}/{x}/{y}.terrain in the geographic TMS scheme (two tiles
/// at level 0, y from the south) and layer.json, which is written last. Tiles of all levels that touch the model, and
/// the two of level 0. Every tile is sampled on 129 x 129 places of the true surface and thinned by greedy refinement,
/// whose choice along an edge depends on that edge alone; heights of all tiles are whole multiples of one step, a power
/// of two. So tiles of a level that share an edge have the same vertices there, decoded to the same bits, and the same
/// normals: no cracks, and no skirts are needed. (Between levels a viewer sees steps of the tolerance.) Throws BadInput
/// (no CRS, a model of less than a cell), UsageError (level 0 to 24; a million tiles), CannotWrite.
/// A tile is sampled at once, tiles one level after the other and neighbours soon after each other.
GlobeNotes write_quantized_mesh(const GlobeSurface& surface, const std::string& folder,
                                const QuantizedMeshOptions& options = {}, bool overwrite = false,
                                const Context& context = {});
GlobeNotes write_quantized_mesh(const TerrainEvaluator& model, const std::string& folder,
                                const QuantizedMeshOptions& options = {}, bool overwrite = false,
                                const Context& context = {});

struct TilesetOptions {
  double tolerance = 0;              ///< as mesh_terrain's
  std::size_t triangles = 1U << 16;  ///< of a tile, about
};

/// 3D Tiles 1.1: tileset.json, written last, and one .glb a tile. The surface is meshed once, to the tolerance, then
/// cut into tiles by its triangles' middles. Every vertex is put on the globe (WGS 84) by itself, so that the curvature
/// of the earth and the scale of the projection are right, and written in east, north, up at the middle of the model;
/// the root's transform takes that to earth-centred coordinates. In a .glb up is y, as glTF wants it and 3D Tiles
/// expects; positions are single precision about the tile's own middle (the node's translation), on a lattice of a
/// power of two that loses nothing: tiles that share a vertex have it to the last bit. Throws BadInput (no CRS,
/// coordinates that cannot be put on the globe), UsageError, CannotWrite.
/// While it is made 48 bytes a vertex (96 where the surface comes tile by tile) and 12 (24) a triangle lie on disk in
/// the folder, in files without names.
GlobeNotes write_tileset(const Terrain& terrain, const std::string& folder, const TilesetOptions& options = {},
                         bool overwrite = false, const Context& context = {});
/// The same of a surface that comes tile by tile: the very files of the joined one. Memory: write_tile_mesh's, one tile
/// of the output, and 3 kB for each.
GlobeNotes write_tileset(const TileSource& tiles, const std::string& folder, const TilesetOptions& options = {},
                         bool overwrite = false, const Context& context = {});

}  // namespace retalho
