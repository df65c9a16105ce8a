// Meshes of tiles put together: vertices on seams become one, and what check_mesh asks is known at the end.
// Internal to the room.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "retalho/mesh/mesh_spool.h"
#include "retalho/mesh/open_edges.h"
#include "retalho/terrain/tile_source.h"

namespace retalho {

/// Sides of a tile beyond which there is another one, as bits.
enum SeamSide : std::uint8_t { kNoSeam = 0, kNorthSeam = 1, kWestSeam = 2, kSouthSeam = 4, kEastSeam = 8 };

/// A tile's mesh with what its seams are told by, made before it is joined.
struct TileMesh {
  TriangleMesh mesh;
  MeshCheck check;
  std::vector<std::uint32_t> parts;  ///< parts_of
  std::size_t part_count = 0;
  std::vector<std::uint8_t> seams;  ///< of each vertex: the sides that it lies on
  /// Of a linear surface, whose normals are means: what each triangle gives a vertex on a seam, in their order.
  struct Share {
    Vec2 place;
    std::uint8_t seams;
    Vec3 twice_area;
  };
  std::vector<Share> shares;
};

/// The mesh of a tile, and what is asked of it; triangles whose centre is in the void are left out.
TileMesh mesh_tile(PlacedTile tile, double tolerance, const TilePlace& place, const Context& context);

class SeamMesh {
 public:
  static constexpr std::uint64_t kMostVertices = std::numeric_limits<std::uint32_t>::max();
  explicit SeamMesh(MeshSpool& spool, std::uint64_t most_vertices = kMostVertices)
      : spool_(spool), most_vertices_(most_vertices) {}

  /// The next tile, row by row; `last_of_row`: the next one begins a row. Throws CannotRead where neighbours have other
  /// heights on their seam, BadInput for more vertices than the indices of files can name.
  void add(const TileMesh& tile, bool last_of_row);
  /// When all tiles have been added.
  MeshCheck finish();

 private:
  using Place = std::array<double, 2>;
  struct PlaceHash {
    std::size_t operator()(const Place& p) const;
  };
  struct Known {
    double height = 0;
    std::uint32_t number = kNoPart;  ///< in the spool; kNoPart: no triangle has used it yet
    std::uint32_t part = kNoPart;
    Vec3 sum;  ///< of the shares
    bool shared = false;
  };
  struct Waiting {
    bool upwards;  ///< from the lower number to the higher one
    OpenEdge edge;
  };
  /// Vertices by their place, and the edges of one tile that wait for the other's.
  struct Seam {
    std::unordered_map<Place, Known, PlaceHash> vertices;
    std::unordered_map<std::uint64_t, Waiting> edges;
    std::vector<OpenEdge> alone;  ///< of the second tile, without a like in the first
  };

  Seam& seam_of(std::uint8_t seams);
  std::vector<std::uint32_t> place_vertices(const TileMesh& tile);
  void join_edges(const TileMesh& tile, const std::vector<std::uint32_t>& numbers);
  void leave(Seam& seam);
  std::uint32_t root(std::uint32_t part);

  MeshSpool& spool_;
  std::uint64_t most_vertices_;
  Seam above_, below_;  ///< of the whole row of tiles
  Seam west_, east_;
  std::vector<std::uint32_t> parent_;  ///< of the parts of all tiles
  MeshCheck check_;
};

/// Meshes all tiles into the spool: what write_tile_mesh writes.
MeshCheck spool_tile_mesh(const TileSource& tiles, double tolerance, MeshSpool& spool, const Context& context);

}  // namespace retalho
