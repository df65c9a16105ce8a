// The model file gives back what it was given, to the bit, and refuses everything else.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <memory>

#include "identical.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/terrain/evaluate.h"
#include "support/sample_terrain.h"

namespace retalho {
namespace {

using test::identical;
using test::sample_terrain;
using test::SampleOptions;

Terrain round_trip(const Terrain& t) {
  return std::get<Terrain>(decode_model(encode_model(t)));
}

/// A model of every kind, small enough to try every byte of its file.
std::vector<Terrain> one_of_each() {
  std::vector<Terrain> all;
  all.push_back(sample_terrain({.kind = SurfaceKind::linear, .columns = 3, .rows = 3}));
  all.push_back(sample_terrain(
      {.kind = SurfaceKind::linear, .columns = 2, .rows = 2, .on_grid = false, .integer_heights = false}));
  all.push_back(sample_terrain({.kind = SurfaceKind::powell_sabin, .columns = 3, .rows = 3, .mask = true}));
  all.push_back(
      sample_terrain({.kind = SurfaceKind::clough_tocher, .columns = 3, .rows = 2, .mask = true, .cell_width = 30.8}));
  all.push_back(sample_terrain(
      {.kind = SurfaceKind::clough_tocher, .cross_derivative = CrossDerivative::cubic, .columns = 3, .rows = 3}));
  Terrain whole = sample_terrain({.kind = SurfaceKind::linear, .columns = 2, .rows = 2});
  whole.grid.valid = Mask(whole.grid.columns, whole.grid.rows, true);
  all.push_back(whole);
  return all;
}

/// Decodes from a buffer of exactly that size, at that distance from an aligned address, so that the address sanitizer
/// sees the first byte read beyond it. Returns the message; empty when it was taken.
std::string refusal(std::string_view bytes, std::size_t shift = 0) {
  const std::unique_ptr<char[]> buffer(new char[bytes.size() + shift]);
  std::copy(bytes.begin(), bytes.end(), buffer.get() + shift);
  try {
    decode_model({buffer.get() + shift, bytes.size()}, "m.retalho");
  } catch (const CannotRead& e) {
    EXPECT_EQ(e.file(), "m.retalho");
    EXPECT_NE(std::string(e.what()).find("m.retalho"), std::string::npos) << e.what();
    return e.what();
  }
  return {};
}

TEST(ModelFile, GivesBackEveryKindToTheBit) {
  for (const Terrain& t : one_of_each()) EXPECT_TRUE(identical(round_trip(t), t));
}

TEST(ModelFile, TheSameModelGivesTheSameBytes) {
  for (const Terrain& t : one_of_each()) {
    const std::string bytes = encode_model(t);
    EXPECT_EQ(encode_model(Terrain(t)), bytes);
    EXPECT_EQ(encode_model(decode_model(bytes)), bytes);
  }
}

TEST(ModelFile, ReadsFromAnyAddress) {
  const std::string bytes = encode_model(one_of_each()[2]);
  for (std::size_t shift = 0; shift < 8; ++shift) EXPECT_EQ(refusal(bytes, shift), "") << shift;
}

TEST(ModelFile, EveryProperPrefixIsRefused) {
  std::size_t tried = 0;
  for (const Terrain& t : one_of_each()) {
    const std::string bytes = encode_model(t);
    ASSERT_EQ(refusal(bytes), "");
    for (std::size_t size = 0; size < bytes.size(); ++size, ++tried)
      ASSERT_NE(refusal(std::string_view(bytes).substr(0, size)), "") << size;
  }
  EXPECT_GT(tried, 4000U);
}

TEST(ModelFile, EveryChangedByteIsRefused) {
  std::size_t tried = 0;
  for (const Terrain& t : one_of_each()) {
    std::string bytes = encode_model(t);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      const char before = bytes[at];
      for (int flip : {0x01, 0x02, 0x04, 0x08, 0x10, 0x20, 0x40, 0x80, 0xff}) {
        bytes[at] = static_cast<char>(before ^ flip);
        ASSERT_NE(refusal(bytes), "") << "byte " << at << " of " << bytes.size() << ", flipped by " << flip;
        ++tried;
      }
      bytes[at] = before;
    }
  }
  EXPECT_GT(tried, 40000U);
}

TEST(ModelFile, BytesBehindTheEndAreRefused) {
  std::string bytes = encode_model(one_of_each()[0]);
  bytes.push_back('\0');
  EXPECT_NE(refusal(bytes).find("should have"), std::string::npos) << refusal(bytes);
}

TEST(ModelFile, SaysWhatIsWrong) {
  const std::string bytes = encode_model(one_of_each()[0]);
  EXPECT_NE(refusal("").find("empty"), std::string::npos);
  EXPECT_NE(refusal("II*").find("not a Retalho model"), std::string::npos);
  EXPECT_NE(refusal(std::string_view(bytes).substr(0, bytes.size() / 2)).find("cut short"), std::string::npos);
  std::string newer = bytes;
  newer[8] = 2;
  EXPECT_NE(refusal(newer).find("newer Retalho (format 2"), std::string::npos) << refusal(newer);
  std::string damaged = bytes;
  damaged[bytes.size() - 5] ^= 1;
  EXPECT_NE(refusal(damaged).find("checksum"), std::string::npos) << refusal(damaged);
}

TEST(ModelFile, WillNotWriteAModelWithAFault) {
  const auto fails = [](auto&& change) {
    Terrain t = sample_terrain({.kind = SurfaceKind::powell_sabin, .columns = 3, .rows = 3, .mask = true});
    change(t);
    EXPECT_THROW(encode_model(t), BadInput);
  };
  fails([](Terrain& t) { t.tin.heights[2] = std::numeric_limits<double>::quiet_NaN(); });
  fails([](Terrain& t) { t.tin.points[2].x = std::numeric_limits<double>::infinity(); });
  fails([](Terrain& t) { t.gradients[0].y = std::numeric_limits<double>::quiet_NaN(); });
  fails([](Terrain& t) { t.gradients.pop_back(); });
  fails([](Terrain& t) { t.edge_split.pop_back(); });
  fails([](Terrain& t) { t.edge_split[0] = 0; });
  fails([](Terrain& t) { t.edge_fallback.push_back(0); });
  fails([](Terrain& t) { std::swap(t.tin.triangles[0][0], t.tin.triangles[0][1]); });
  fails([](Terrain& t) { t.tin.neighbors[0] = {kNone, kNone, kNone}; });
  fails([](Terrain& t) { t.tin.triangles[0][0] = 99; });
  fails([](Terrain& t) { t.grid.valid = Mask(2, 2, true); });
  fails([](Terrain& t) { t.grid.valid.words()[0] |= std::uint64_t{1} << 63; });
  fails([](Terrain& t) { t.grid.cell_width = 0; });
  fails([](Terrain& t) { t.georef.scale_x = 0; });
  fails([](Terrain& t) { t.tolerance = -1; });
  fails([](Terrain& t) { t.kind = static_cast<SurfaceKind>(9); });
  fails([](Terrain& t) { t.tin.triangles.clear(), t.tin.neighbors.clear(), t.edge_split.clear(); });
}

TEST(ModelFile, SavesAndLoads) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("retalho-model-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string path = (folder / "m.retalho").string(), other = (folder / "other").string();
  const Terrain t = one_of_each()[2];
  save_model(t, path);
  EXPECT_TRUE(identical(std::get<Terrain>(load_model(path)), t));
  EXPECT_THROW(save_model(t, path), CannotWrite);
  save_model(t, path, true);
  write_file(other, "P5 no model", false);
  EXPECT_TRUE(is_model_file(path));
  EXPECT_FALSE(is_model_file(other));
  EXPECT_FALSE(is_model_file((folder / "missing").string()));
  EXPECT_FALSE(is_model_file(folder.string()));
  EXPECT_THROW(load_model(other), CannotRead);
  fs::remove_all(folder);
}

RC_GTEST_PROP(ModelFileProperty, TheModelReadEvaluatesToTheSameBits, ()) {
  SampleOptions o;
  o.kind = *rc::gen::element(SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher);
  o.cross_derivative = *rc::gen::element(CrossDerivative::perpendicular, CrossDerivative::cubic);
  o.mask = *rc::gen::arbitrary<bool>();
  o.on_grid = *rc::gen::arbitrary<bool>();
  o.seed = *rc::gen::arbitrary<std::uint64_t>();
  const Terrain saved = sample_terrain(o), read = round_trip(saved);
  const TerrainEvaluator a(saved), b(read);
  std::size_t with_data = 0;
  for (int i = 0; i < 200; ++i) {
    const int column = i % 20, row = i / 20;
    const Vec2 p{column * 0.61 - 0.1, 0.1 - row * 0.93};
    const double z = a.value(p);
    RC_ASSERT(std::bit_cast<std::uint64_t>(z) == std::bit_cast<std::uint64_t>(b.value(p)));
    with_data += !std::isnan(z);
  }
  RC_ASSERT(with_data > 50U);
}

RC_GTEST_PROP(ModelFileProperty, TheModelReadIsTheModelSavedToTheBit, ()) {
  SampleOptions o;
  o.kind = *rc::gen::element(SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher);
  o.cross_derivative = *rc::gen::element(CrossDerivative::perpendicular, CrossDerivative::cubic);
  o.columns = *rc::gen::inRange(2, 40);
  o.rows = *rc::gen::inRange(2, 40);
  o.on_grid = *rc::gen::arbitrary<bool>();
  o.integer_heights = *rc::gen::arbitrary<bool>();
  o.mask = *rc::gen::arbitrary<bool>();
  o.drop = *rc::gen::element(0.0, 0.1, 0.6);
  o.cell_width = *rc::gen::element(1.0, 30.0, 23.456789, 1e-5);
  o.cell_height = *rc::gen::element(1.0, 30.887, 0.1);
  o.shuffled = *rc::gen::arbitrary<bool>();
  o.seed = *rc::gen::arbitrary<std::uint64_t>();
  const Terrain t = sample_terrain(o);
  RC_CLASSIFY(t.grid.valid.empty(), "no mask");
  RC_CLASSIFY(o.on_grid, "on the grid");
  RC_ASSERT(identical(round_trip(t), t));
}

}  // namespace
}  // namespace retalho
