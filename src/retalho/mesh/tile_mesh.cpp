#include "retalho/mesh/tile_mesh.h"

#include <optional>
#include <vector>

#include "retalho/mesh/formats.h"
#include "retalho/mesh/mesh_frame.h"
#include "retalho/mesh/seam_mesh.h"

namespace retalho {

MeshCheck spool_tile_mesh(const TileSource& tiles, double tolerance, MeshSpool& spool, const Context& context) {
  SeamMesh joined(spool);
  std::vector<TileMesh> slots(tile_slots(tiles, context));
  each_tile(
      tiles, "mesh", context,
      [&](const PlacedTile* tile, const TilePlace& place, std::size_t s, const Context& inside) {
        slots[s] = tile == nullptr ? TileMesh{} : mesh_tile(*tile, tolerance, place, inside);
      },
      [&](const TilePlace& place, std::size_t s) {
        joined.add(slots[s], !place.east);
        slots[s] = {};
      });
  return joined.finish();
}

TileMeshFacts write_tile_mesh(const TileSource& tiles, double tolerance, const std::string& path, bool overwrite,
                              const Context& context) {
  TileMeshFacts facts;
  std::optional<MeshSpool> spool;  // outlives the stream
  write_stream(path, overwrite, [&](const std::string& temporary) {
    spool.emplace(temporary, path);
    facts.check = spool_tile_mesh(tiles, tolerance, *spool, context);
    facts.vertices = spool->vertices();
    facts.triangles = spool->triangles();
    MeshStream stream = spool->stream();
    const MeshFrame frame = mesh_frame(tiles.georef);
    stream.offset = frame.offset;
    stream.unit = frame.unit;
    stream.crs_wkt = frame.crs_wkt;
    return stream;
  });
  return facts;
}

}  // namespace retalho
