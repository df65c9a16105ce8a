// The mesh of a tiled model, made tile by tile: the joined model's, without cracks over seams.
#include "retalho/mesh/tile_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <tuple>
#include <vector>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/mesh/mesh_spool.h"
#include "retalho/mesh/seam_mesh.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/model/model.h"
#include "retalho/tiles/make.h"
#include "retalho/tiles/source.h"
#include "support/support.h"
#include "tiles/made.h"

namespace retalho {
namespace {

using test::MadeTiles;
using Case = test::TileCase;

using Corner = std::tuple<double, double, double>;
Corner corner(const TriangleMesh& mesh, std::uint32_t v) {
  const Vec3 p = mesh.positions[v];
  return {p.x, p.y, p.z};
}

class MeshOfTiles : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Kinds, MeshOfTiles,
    ::testing::Values(Case{false, SurfaceKind::linear, false}, Case{true, SurfaceKind::linear, false},
                      Case{false, SurfaceKind::clough_tocher, false}, Case{true, SurfaceKind::clough_tocher, false},
                      Case{false, SurfaceKind::powell_sabin, true}, Case{true, SurfaceKind::powell_sabin, false}));

TEST_P(MeshOfTiles, IsTheJoinedModelsTriangleByTriangle) {
  const auto [voids, surface, fitted] = GetParam();
  const MadeTiles made(voids, surface, 1.5, fitted);
  make_tiles(made.plan, made.tiles, 2, false);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const std::string joined_path = (made.folder.path() / "joined.ply").string(),
                    path = (made.folder.path() / "tiles.ply").string();
  const TriangleMesh in_memory = mesh_terrain(whole, {.tolerance = 0.4});
  write_mesh(in_memory, joined_path);
  const TileMeshFacts facts = write_tile_mesh(tile_source(made.tiles), 0.4, path);
  const TriangleMesh expected = read_mesh(joined_path), got = read_mesh(path);
  ASSERT_EQ(got.positions.size(), expected.positions.size());
  ASSERT_EQ(got.triangles.size(), expected.triangles.size());
  EXPECT_EQ(facts.vertices, got.positions.size());
  EXPECT_EQ(facts.triangles, got.triangles.size());
  EXPECT_GT(got.triangles.size(), surface == SurfaceKind::linear ? 800U : 5000U);
  ASSERT_EQ(got.normals.size(), expected.normals.size());
  for (std::size_t t = 0; t < got.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = got.triangles[t][k], b = expected.triangles[t][k];
      ASSERT_EQ(corner(got, a), corner(expected, b)) << "triangle " << t;
      ASSERT_LT(norm(got.normals[a] - expected.normals[b]), voids ? 1e-6 : 1e-12) << "triangle " << t;
    }
  // What the notes say is what the file holds.
  const MeshCheck check = check_mesh(got);
  EXPECT_TRUE(facts.check.watertight());
  EXPECT_TRUE(check.watertight());
  EXPECT_EQ(facts.check.open_edges, check.open_edges);
  EXPECT_EQ(facts.check.boundary_edges, check.boundary_edges);
  EXPECT_EQ(facts.check.components, check.components);
  EXPECT_EQ(facts.check.degenerate_triangles, check.degenerate_triangles);
}

TEST(TileMesh, EveryFormatIsAsFromMemoryAndTheSameFromAnyNumberOfThreads) {
  const MadeTiles made(true);
  make_tiles(made.plan, made.tiles, 2, false);
  const std::string path = (made.folder.path() / "mesh").string();
  for (const char* ending : {".ply", ".obj", ".stl", ".glb", ".xml"}) {
    write_tile_mesh(tile_source(made.tiles), 0.4, path + ending, true, {.threads = 1});
    const std::string bytes = read_file(path + ending);
    if (std::string(ending) == ".ply") {
      // From memory: the same vertices in the same order are the same file, whatever its format.
      TriangleMesh mesh = read_mesh(path + ending);
      mesh.unit = "metre";
      write_mesh(mesh, path + ".again.ply");
      EXPECT_EQ(read_file(path + ".again.ply"), bytes);
    }
    for (const int threads : {2, 7})
      for (const std::size_t bound : {std::size_t{1}, TileReader::kBound}) {
        write_tile_mesh(tile_source(made.tiles, bound), 0.4, path + ending, true, {.threads = threads});
        EXPECT_TRUE(read_file(path + ending) == bytes) << ending << " " << threads;
      }
  }
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(made.folder.path())) {
    EXPECT_NE(entry.path().filename().string().front(), '.') << "left behind";
    ++files;
  }
  EXPECT_EQ(files, 8U);
}

/// The corners of all triangles in a file, in their order.
std::vector<std::array<Corner, 3>> corners_in(const std::string& path) {
  const TriangleMesh mesh = read_mesh(path);
  std::vector<std::array<Corner, 3>> corners;
  for (const auto& t : mesh.triangles) corners.push_back({corner(mesh, t[0]), corner(mesh, t[1]), corner(mesh, t[2])});
  return corners;
}

TEST(TileMesh, ObjAndStlAreTheJoinedModelsAsShapes) {
  for (const bool voids : {false, true}) {
    const MadeTiles made(voids);
    make_tiles(made.plan, made.tiles, 2, false);
    const TriangleMesh joined = mesh_terrain(std::get<Terrain>(load_model(made.tiles)), {.tolerance = 0.4});
    const std::string path = (made.folder.path() / "tiles").string(), whole = (made.folder.path() / "whole").string();
    for (const char* ending : {".obj", ".stl"}) {
      write_tile_mesh(tile_source(made.tiles), 0.4, path + ending);
      write_mesh(joined, whole + ending);
    }
    // OBJ numbers vertices, and each has an order of its own; STL has none: the same triangles are the same bytes.
    EXPECT_EQ(corners_in(path + ".obj"), corners_in(whole + ".obj"));
    EXPECT_GT(corners_in(path + ".obj").size(), 5000U);
    EXPECT_TRUE(read_file(path + ".stl") == read_file(whole + ".stl"));
  }
}

TEST(TileMesh, TilesThatDifferOnTheirSeamAreRefused) {
  const MadeTiles made(false);
  make_tiles(made.plan, made.tiles, 2, false);
  const std::string path = (made.folder.path() / "mesh.ply").string();
  TileSource tiles = tile_source(made.tiles);
  const auto load = tiles.load;
  tiles.load = [&](int row, int column) {
    std::optional<PlacedTile> tile = load(row, column);
    if (row == 1 && column == 1) tile->terrain.tin.heights[0] += 1e-9;  // of the corner
    return tile;
  };
  try {
    write_tile_mesh(tiles, 0.4, path);
    FAIL();
  } catch (const CannotRead& error) {
    EXPECT_NE(std::string(error.what()).find("differ at local place"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

/// Two triangles side by side, of two tiles; `gap` moves one end of the second one's edge along the seam.
struct Halves {
  TileMesh west, east;

  explicit Halves(double gap) {
    west.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
    east.mesh.positions = {{1, 0, 0}, {2, 0, 0}, {1, 1 - gap, 0}};
    west.seams = {kNoSeam, kEastSeam, kEastSeam};
    east.seams = {kWestSeam, kNoSeam, kWestSeam};
    for (TileMesh* half : {&west, &east}) {
      half->mesh.triangles = {{0, 1, 2}};
      half->mesh.normals.assign(3, {0, 0, 1});
      half->check = check_mesh(half->mesh);
      half->parts = parts_of(half->mesh, half->part_count);
    }
  }
};

TEST(SeamMesh, CountsWhatCheckMeshCounts) {
  const test::ScratchFolder folder;
  for (const double gap : {0.0, 0.25}) {
    const Halves halves(gap);
    MeshSpool spool(folder / "m", folder / "m");
    SeamMesh joined(spool);
    joined.add(halves.west, false);
    joined.add(halves.east, true);
    const MeshCheck check = joined.finish();
    EXPECT_EQ(check.watertight(), gap == 0);
    EXPECT_EQ(check.cracks, gap == 0 ? 0U : 2U);
    EXPECT_EQ(check.boundary_edges, 4U);
    EXPECT_EQ(check.components, 1U) << "they share a corner at least";
    EXPECT_EQ(spool.vertices(), gap == 0 ? 4U : 5U);
    TriangleMesh whole;
    const MeshStream stream = spool.stream();
    stream.each_vertex([&](const VertexBlock& block) {
      whole.positions.insert(whole.positions.end(), block.positions.begin(), block.positions.end());
    });
    stream.each_triangle(
        [&](TriangleBlock block) { whole.triangles.insert(whole.triangles.end(), block.begin(), block.end()); });
    const MeshCheck expected = check_mesh(whole);
    EXPECT_EQ(check.cracks, expected.cracks);
    EXPECT_EQ(check.open_edges, expected.open_edges);
    EXPECT_EQ(check.components, expected.components);
  }
}

TEST(SeamMesh, MoreVerticesThanFilesCanNumberAreRefused) {
  const test::ScratchFolder folder;
  const Halves halves(0);
  MeshSpool spool(folder / "m", folder / "m");
  SeamMesh joined(spool, 5);
  joined.add(halves.west, false);
  EXPECT_THROW(joined.add(halves.east, true), BadInput) << "the mesh has more than 5 vertices";
}

TEST(MeshSpool, GivesBackWhatItGot) {
  const test::ScratchFolder folder;
  MeshSpool spool(folder / "m", folder / "m");
  constexpr std::uint32_t kCount = 20000;
  for (std::uint32_t v = 0; v < kCount; ++v) EXPECT_EQ(spool.add_vertex({1.0 * v, -2.0 * v, 0.5}, {0, 0, 1}), v);
  for (std::uint32_t v = 0; v < kCount; v += 7) spool.set_normal(v, {0, 1.0 * v, 0});
  for (std::uint32_t v = 2; v < kCount; ++v) spool.add_triangle({v - 2, v - 1, v});
  const MeshStream stream = spool.stream();
  EXPECT_EQ(stream.vertices, kCount);
  EXPECT_EQ(stream.low, (Vec3{0, -2.0 * (kCount - 1), 0.5}));
  EXPECT_EQ(stream.high, (Vec3{1.0 * (kCount - 1), 0, 0.5}));
  std::uint32_t v = 0;
  stream.each_vertex([&](const VertexBlock& block) {
    for (std::size_t i = 0; i < block.positions.size(); ++i, ++v) {
      ASSERT_EQ(block.positions[i].x, v);
      ASSERT_EQ(block.normals[i], (v % 7 == 0 ? Vec3{0, 1.0 * v, 0} : Vec3{0, 0, 1}));
    }
  });
  EXPECT_EQ(v, kCount);
  std::uint32_t t = 0;
  stream.each_triangle([&](TriangleBlock block) {
    for (const auto& triangle : block) ASSERT_EQ(triangle[0], t++);
  });
  EXPECT_EQ(t, kCount - 2);
  test::Random random;
  for (int k = 0; k < 1000; ++k) {
    const auto at = static_cast<std::uint32_t>(random.uniform(0, kCount - 1));
    EXPECT_EQ(stream.position(at).x, at);
  }
  EXPECT_THROW(MeshSpool("/nowhere/at/all", "x"), CannotWrite);
}

TEST(MeshSpool, LeavesNothingOpenWhereItsSecondFileCannotBeMade) {
  const test::ScratchFolder folder;
  const auto open_files = [] {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return std::distance(begin(all), end(all));
  };
  std::filesystem::create_directory(folder.path() / "m.triangles");
  const auto before = open_files();
  for (int k = 0; k < 5; ++k) EXPECT_THROW(MeshSpool(folder / "m", "x"), CannotWrite);
  EXPECT_EQ(open_files(), before);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "m.vertices"));
}

}  // namespace
}  // namespace retalho
