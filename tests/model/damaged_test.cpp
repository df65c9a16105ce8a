// What is said of a model file that is whole to FlatBuffers and the checksum, and wrong: each message of the decoders,
// made by taking a sound content apart and changing one part.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "model_parts_generated.h"
#include "retalho/core/error.h"
#include "retalho/model/model_codec.h"
#include "retalho/model/numbers.h"
#include "support/errors.h"
#include "support/sample_patches.h"
#include "support/sample_terrain.h"
#include "support/sample_tetraquad.h"

namespace retalho {
namespace {

namespace parts = model_parts;
using test::sample_terrain;

template <class Table>
struct Damage {
  const char* words;
  std::function<void(Table&)> change;
};

template <class Table>
Table& surface_of(parts::ModelFileT& file);
template <>
parts::TerrainSurfaceT& surface_of(parts::ModelFileT& file) {
  return *file.surface.AsTerrainSurface();
}
template <>
parts::TetraQuadSurfaceT& surface_of(parts::ModelFileT& file) {
  return *file.surface.AsTetraQuadSurface();
}
template <>
parts::AdaptiveTetraQuadSurfaceT& surface_of(parts::ModelFileT& file) {
  return *file.surface.AsAdaptiveTetraQuadSurface();
}
template <>
parts::PatchTableT& surface_of(parts::ModelFileT& file) {
  return *file.surface.AsPatchSetSurface()->patches.at(0);
}

/// Each change of `model` is refused in its words.
template <class Table>
void expect_refused(const Model& model, std::initializer_list<Damage<Table>> rows) {
  const std::string sound = encode_content(model);
  for (const Damage<Table>& row : rows) {
    const std::unique_ptr<parts::ModelFileT> file(parts::GetModelFile(sound.data())->UnPack());
    row.change(surface_of<Table>(*file));
    flatbuffers::FlatBufferBuilder builder;
    parts::FinishModelFileBuffer(builder, parts::ModelFile::Pack(builder, file.get()));
    const std::string content(reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize());
    EXPECT_TRUE(test::holds(test::words_of<CannotRead>([&] { decode_content(content); }), row.words));
  }
}

std::unique_ptr<parts::NumbersT> integers(const std::vector<std::int64_t>& values) {
  const PackedNumbers packed = pack_integers(values);
  auto table = std::make_unique<parts::NumbersT>();
  table->count = packed.count;
  table->form = parts::NumberForm::integers;
  table->width = packed.width;
  table->differences = packed.differences;
  table->zstd.assign(packed.bytes.begin(), packed.bytes.end());
  return table;
}

/// A zstd frame that states `size` bytes (below 256) and whose one block is not what its head says.
std::vector<std::uint8_t> broken_frame(std::size_t size) {
  constexpr std::uint8_t kOneSegment = 0x20, kCompressedAndLast = 5, kBytes = 16;
  std::vector<std::uint8_t> frame{
      0x28, 0xb5, 0x2f, 0xfd, kOneSegment, static_cast<std::uint8_t>(size), kBytes << 3 | kCompressedAndLast, 0, 0};
  frame.insert(frame.end(), kBytes, 0xff);
  return frame;
}

TEST(DamagedModel, NumbersAreNamed) {
  using Terrain = parts::TerrainSurfaceT;
  expect_refused<Terrain>(
      sample_terrain({.columns = 4, .rows = 3}),
      {{"heights has 13 numbers where the model needs 12", [](Terrain& t) { t.heights->count = 13; }},
       {"heights has numbers of 3 bytes", [](Terrain& t) { t.heights->width = 3; }},
       {"heights is not one zstd frame of", [](Terrain& t) { t.heights->zstd.push_back(0); }},
       {"corner_a cannot be decompressed",
        [](Terrain& t) { t.corner_a->zstd = broken_frame(t.corner_a->count * t.corner_a->width); }},
       {"cells is not stored as integers", [](Terrain& t) { t.cells->form = parts::NumberForm::real64; }},
       {"heights is stored in a form that this Retalho does not know",
        [](Terrain& t) { t.heights->form = static_cast<parts::NumberForm>(7); }},
       {"heights has reals of 4 bytes", [](Terrain& t) {
          t.heights->form = parts::NumberForm::real64;
          t.heights->width = 4;
        }}});
}

TEST(DamagedModel, TerrainsAreNamed) {
  using Terrain = parts::TerrainSurfaceT;
  expect_refused<Terrain>(sample_terrain({.columns = 4, .rows = 3, .on_grid = false, .mask = true}),
                          {{"a mask on a grid of 0 x 7 cells", [](Terrain& t) { t.grid->columns = 0; }},
                           {"the mask is stored in a form that this Retalho does not know",
                            [](Terrain& t) { t.grid->mask->form = static_cast<parts::MaskForm>(5); }},
                           {"a mask of 131072 x 131072 cells", [](Terrain& t) {
                              t.grid->columns = t.grid->rows = 131072;
                              t.grid->mask->form = parts::MaskForm::every_cell;
                            }}});
  expect_refused<Terrain>(
      sample_terrain({.columns = 4, .rows = 3}),
      {{"a vertex lies in cell 99999 of 70",
        [](Terrain& t) {
          t.cells = integers({0, 1, 99999, 3, 4, 5, 6, 7, 8, 9, 10, 11});
        }},
       {"1000 creases of 23 edges", [](Terrain& t) { t.creases = integers(std::vector<std::int64_t>(1000, 1)); }},
       {"crease 23 is none of the 23 edges", [](Terrain& t) { t.creases = integers({23}); }}});
}

TEST(DamagedModel, TetraQuadsAreNamed) {
  using Grid = parts::TetraQuadSurfaceT;
  expect_refused<Grid>(test::sample_tetraquad(),
                       {{"the model is damaged: not ten coefficients a vertex", [](Grid& t) { t.quadrics.pop_back(); }},
                        {"an unknown way to cut cubes", [](Grid& t) { t.split = static_cast<parts::TetSplit>(9); }},
                        {"tet_type is 5 in tetrahedron 0",
                         [](Grid& t) { t.tet_type = integers(std::vector<std::int64_t>(t.tetrahedra, 5)); }},
                        {"28 vertices for tetrahedra with 27", [](Grid& t) { t.vertices = 28; }}});
  using Adaptive = parts::AdaptiveTetraQuadSurfaceT;
  const auto marks = [](std::size_t count, std::int64_t mark) {
    return integers(std::vector<std::int64_t>(count, mark));
  };
  expect_refused<Adaptive>(
      test::sample_adaptive_tetraquad(1),
      {{"0 root cubes", [](Adaptive& t) { t.cubes = 0; }},
       {"halved holds 2, not 0 or 1", [&](Adaptive& t) { t.halved = marks(t.nodes, 2); }},
       {"leaves, not 7", [](Adaptive& t) { t.leaves = 7; }},
       {"7 vertices for tetrahedra with", [](Adaptive& t) { t.vertices = 7; }},
       {"the root cubes of an adaptive mesh are out of order", [&](Adaptive& t) { t.cube_x = marks(t.cubes, 0); }},
       {"an adaptive mesh with fewer marks than roots",
        [&](Adaptive& t) {
          t.nodes = 47;
          t.halved = marks(47, 0);
        }},
       {"the marks of an adaptive mesh end inside of a tree",
        [](Adaptive& t) {
          std::vector<std::int64_t> first(48, 0);  // of eight cubes; the first one's children are missing
          first[0] = 1;
          t.nodes = first.size();
          t.halved = integers(first);
        }},
       {"an adaptive mesh with more marks than nodes", [&](Adaptive& t) {
          t.nodes = 49;
          t.halved = marks(49, 0);
        }}});
}

TEST(DamagedModel, PatchesAreNamed) {
  using Patch = parts::PatchTableT;
  expect_refused<Patch>(
      test::sample_patches(2),
      {{"an index is 99, of",
        [](Patch& p) {
          p.sides[0]->node_list = integers({0, 99, 1});
        }},
       {"too many segments", [](Patch& p) { p.sides[0]->segments = std::uint64_t{1} << 31; }},
       {"an unknown placement", [](Patch& p) { p.sides[0]->placement = static_cast<parts::PatchPlacement>(9); }},
       {"more vertices or triangles than 32 bits can number", [](Patch& p) { p.vertices = std::uint64_t{1} << 33; }},
       {"an unknown recovery", [](Patch& p) { p.recovery = static_cast<parts::PatchRecovery>(9); }},
       {"a patch without three sides", [](Patch& p) { p.sides.pop_back(); }}});
}

TEST(DamagedModel, WhatIsUnsoundIsNotSaved) {
  Terrain terrain = sample_terrain({});
  terrain.tolerance = -1;
  TetraQuad ball = test::sample_tetraquad();
  ball.mesh.step = 0;
  PatchSet patches = test::sample_patches(2);
  patches.patches[0].positions[0].x = std::numeric_limits<double>::infinity();
  test::expect_refused<BadInput>({
      {"this terrain cannot be saved: the tolerance is not a number from 0 up", [&] { encode_content(terrain); }},
      {"this TetraQuad cannot be saved: the step of the grid is not a positive number", [&] { encode_content(ball); }},
      {"these patches cannot be saved: ", [&] { encode_content(patches); }},
  });
}

}  // namespace
}  // namespace retalho
