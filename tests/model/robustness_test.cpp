// What reading makes of content that got past the checksum: FlatBuffers' verifier and the semantic checks alone must
// hold. Either an error, or a model without a fault; never a crash (address and undefined-behaviour sanitizers), and
// never an allocation that the file's own size does not vouch for.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>

#include "allocations.h"
#include "retalho/core/error.h"
#include "retalho/model/check.h"
#include "retalho/model/envelope.h"
#include "retalho/model/model_codec.h"
#include "retalho/model/numbers.h"
#include "support/sample_patches.h"
#include "support/sample_terrain.h"
#include "support/sample_tetraquad.h"

namespace retalho {
namespace {

using test::largest_allocation;
using test::sample_terrain;

enum class Outcome { model, refused };

/// Reads it as the content of a file, sealed anew, from a buffer of exactly its size.
Outcome read(const std::string& content) {
  const std::string file = seal(content);
  const std::unique_ptr<char[]> exact(new char[file.size()]);
  std::copy(file.begin(), file.end(), exact.get());
  try {
    const Model model = decode_model({exact.get(), file.size()}, "m.retalho");
    EXPECT_EQ(std::visit([](const auto& shape) { return find_fault(shape); }, model), "");
    return Outcome::model;
  } catch (const CannotRead& e) {
    EXPECT_GT(std::strlen(e.what()), 30U) << e.what();
    return Outcome::refused;
  }
}

std::vector<std::string> contents() {
  std::vector<std::string> all;
  all.push_back(encode_content(sample_terrain({.kind = SurfaceKind::linear, .columns = 4, .rows = 3, .mask = true})));
  all.push_back(encode_content(sample_terrain(
      {.kind = SurfaceKind::powell_sabin, .columns = 4, .rows = 4, .on_grid = false, .integer_heights = false})));
  all.push_back(encode_content(sample_terrain({.kind = SurfaceKind::clough_tocher,
                                               .cross_derivative = CrossDerivative::cubic,
                                               .columns = 4,
                                               .rows = 4,
                                               .mask = true})));
  all.push_back(encode_content(test::sample_tetraquad()));
  all.push_back(encode_content(test::sample_adaptive_tetraquad(1)));
  all.push_back(encode_content(test::sample_patches(1)));
  return all;
}

TEST(ModelContent, EveryChangedByteGivesAnErrorOrASoundModel) {
  std::size_t refused = 0, tried = 0;
  for (std::string content : contents())
    for (std::size_t at = 0; at < content.size(); ++at) {
      const char before = content[at];
      for (const int flip : {0x01, 0x10, 0x80, 0xff}) {
        content[at] = static_cast<char>(before ^ flip);
        refused += read(content) == Outcome::refused;
        ++tried;
      }
      content[at] = before;
    }
  EXPECT_GT(refused, tried / 3) << "of " << tried;
}

TEST(ModelContent, EveryProperPrefixGivesAnErrorOrASoundModel) {
  // FlatBuffers are written back to front, so nothing but padding can stand at the end of a sound one.
  for (const std::string& content : contents())
    for (std::size_t size = 0; size + 8 < content.size(); ++size)
      ASSERT_EQ(read(content.substr(0, size)), Outcome::refused) << size;
}

RC_GTEST_PROP(ModelContentProperty, RandomBytesAreRefused, ()) {
  RC_ASSERT(read(*rc::gen::container<std::string>(rc::gen::arbitrary<char>())) == Outcome::refused);
}

RC_GTEST_PROP(ModelContentProperty, RandomBytesBehindTheIdentifierAreRefused, ()) {
  std::string content =
      *rc::gen::container<std::string>(*rc::gen::inRange<std::size_t>(12, 400), rc::gen::arbitrary<char>());
  content.replace(4, 4, "RTLO");
  content.replace(0, 4, std::string("\x0c\0\0\0", 4));
  RC_ASSERT(read(content) == Outcome::refused);
}

RC_GTEST_PROP(ModelContentProperty, RandomChangesGiveAnErrorOrASoundModel, ()) {
  static const std::vector<std::string> kContents = contents();
  for (int round = 0; round < 20; ++round) {
    std::string content = kContents[*rc::gen::inRange<std::size_t>(0, kContents.size())];
    const int changes = *rc::gen::inRange(1, 6);
    for (int k = 0; k < changes; ++k) {
      const std::size_t at = *rc::gen::inRange<std::size_t>(0, content.size());
      switch (*rc::gen::inRange(0, 4)) {
        case 0:
          content[at] = *rc::gen::arbitrary<char>();
          break;
        case 1:
          content[at] = static_cast<char>(*rc::gen::element(0, 1, 0x7f, 0x80, 0xff));
          break;
        case 2:
          content.erase(at, *rc::gen::inRange<std::size_t>(1, 9));
          break;
        default:
          content.insert(at, content.substr(*rc::gen::inRange<std::size_t>(0, content.size()), 8));
          break;
      }
      if (content.empty()) break;
    }
    read(content);
  }
}

/// Replaces every 8-byte word of the content that holds `from`.
std::string with_words(std::string content, std::uint64_t from, std::uint64_t to, int* replaced) {
  for (std::size_t at = 0; at + 8 <= content.size(); at += 4)
    if (std::memcmp(content.data() + at, &from, 8) == 0) std::memcpy(content.data() + at, &to, 8), ++*replaced;
  return content;
}

TEST(ModelContent, ClaimedSizesAreNotAllocated) {
  const Terrain t = sample_terrain({.kind = SurfaceKind::clough_tocher, .columns = 7, .rows = 5, .mask = true});
  const std::string content = encode_content(t);
  for (const std::uint64_t claim :
       {std::uint64_t{1} << 60, std::uint64_t{0xfffffffe}, std::uint64_t{1} << 28, std::uint64_t{1} << 63}) {
    for (const std::uint64_t count : {std::uint64_t{t.tin.vertex_count()}, std::uint64_t{t.tin.triangle_count()}}) {
      int replaced = 0;
      const std::string changed = with_words(content, count, claim, &replaced);
      EXPECT_GE(replaced, 4) << "the count and its arrays";
      largest_allocation = 0;
      EXPECT_EQ(read(changed), Outcome::refused);
      EXPECT_LT(largest_allocation, 1U << 24) << claim;
    }
  }
  // Columns and rows are two 32-bit numbers side by side.
  for (const std::uint64_t claim :
       {std::uint64_t{0x7fffffff7fffffff}, std::uint64_t{0x0001000000010000}, std::uint64_t{0x7fffffff00000001}}) {
    int replaced = 0;
    const std::string changed = with_words(content, (std::uint64_t{13} << 32) | 19, claim, &replaced);
    EXPECT_EQ(replaced, 1);
    largest_allocation = 0;
    EXPECT_EQ(read(changed), Outcome::refused);
    EXPECT_LT(largest_allocation, 1U << 24) << claim;
  }
}

TEST(ModelContent, AModelWithAFaultIsRefusedThoughEveryArrayIsSound) {
  const auto refused = [](const char* words, auto&& change) {
    for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
      Terrain t = sample_terrain(
          {.kind = kind, .cross_derivative = CrossDerivative::cubic, .columns = 4, .rows = 3, .mask = true});
      const std::string before = encode_content(t, false);
      change(t);
      const std::string after = encode_content(t, false);
      if (after == before) continue;  // a change of what this kind does not have
      try {
        decode_content(after);
        ADD_FAILURE() << "taken: " << words;
      } catch (const CannotRead& e) {
        EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what() << " does not speak of " << words;
      }
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  refused("height of vertex 3", [&](Terrain& t) { t.tin.heights[3] = nan; });
  refused("height of vertex 5", [&](Terrain& t) { t.tin.heights[5] = -infinity; });
  refused("position of vertex 2", [&](Terrain& t) { t.tin.points[2].y = infinity; });
  refused("gradient", [&](Terrain& t) {
    if (!t.gradients.empty()) t.gradients[1].x = nan;
  });
  refused("not split within itself", [&](Terrain& t) {
    if (!t.edge_split.empty()) t.edge_split[4] = 1;
  });
  refused("not split within itself", [&](Terrain& t) {
    if (!t.edge_split.empty()) t.edge_split[4] = nan;
  });
  refused("fallback", [&](Terrain& t) {
    if (!t.edge_fallback.empty()) t.edge_fallback[4] = 2;
  });
  refused("edge_fallback", [&](Terrain& t) {
    if (!t.edge_fallback.empty()) t.edge_fallback.pop_back();
  });
  refused("gradient", [](Terrain& t) {
    if (!t.gradients.empty()) t.gradients.pop_back();
  });
  refused("gradients", [](Terrain& t) { t.gradients.clear(); });
  refused("edge fallbacks", [](Terrain& t) { t.edge_fallback.clear(); });
  refused("edge splits", [](Terrain& t) { t.edge_split.clear(); });
  refused("heights", [](Terrain& t) { t.tin.heights.pop_back(); });
  refused("cell size", [&](Terrain& t) { t.grid.cell_width = 0; });
  refused("cell size", [&](Terrain& t) { t.grid.cell_height = nan; });
  refused("scale", [&](Terrain& t) { t.georef.scale_y = -1; });
  refused("origin", [&](Terrain& t) { t.georef.origin_x = nan; });
  refused("tolerance", [&](Terrain& t) { t.tolerance = nan; });
  refused("kind of gradients", [](Terrain& t) { t.gradient_kind = static_cast<GradientKind>(7); });
  refused("cross derivatives", [](Terrain& t) { t.cross_derivative = static_cast<CrossDerivative>(3); });
  refused("bits behind the last column", [](Terrain& t) { t.grid.valid.words()[1] |= std::uint64_t{1} << 60; });
}

TEST(ModelContent, TrianglesThatAreNoSurfaceAreRefused) {
  const auto refused = [](const char* words, auto&& change) {
    Terrain t = sample_terrain({.kind = SurfaceKind::linear, .columns = 4, .rows = 3});
    change(t.tin);
    try {
      decode_content(encode_content(t, false));
      ADD_FAILURE() << "taken: " << words;
    } catch (const CannotRead& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what() << " does not speak of " << words;
    }
  };
  refused("names vertex 12 of 12", [](Tin& tin) { tin.triangles[2][1] = 12; });
  refused("names vertex", [](Tin& tin) { tin.triangles[2][0] = kNone; });
  refused("twice", [](Tin& tin) { tin.triangles[2][0] = tin.triangles[2][1]; });
  refused("same direction", [](Tin& tin) { tin.triangles.push_back(tin.triangles[0]); });
  refused("not counter-clockwise", [](Tin& tin) {
    tin.triangles.resize(1);
    std::swap(tin.triangles[0][0], tin.triangles[0][1]);
  });
  refused("not counter-clockwise", [](Tin& tin) { tin.points[tin.triangles[0][0]] = tin.points[tin.triangles[0][1]]; });
  refused("no triangles", [](Tin& tin) { tin.triangles.clear(); });
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST(Numbers, EachFormGivesBackEveryBit) {
  const std::vector<std::vector<double>> cases = {
      {},
      {0, 1, -1, 9007199254740992.0, -9007199254740992.0},
      {-0.0, 0.0},
      {12.25, 0.1, -1234.56, 1e6 + 0.000001},
      {static_cast<double>(0.1F), static_cast<double>(-3.4e38F), static_cast<double>(1e-45F)},
      {1.0 / 3, 1e300, 5e-324, -std::numeric_limits<double>::max()},
      {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}};
  const NumberForm forms[] = {NumberForm::integers, NumberForm::integers, NumberForm::real32, NumberForm::integers,
                              NumberForm::real32,   NumberForm::real64,   NumberForm::real64};
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const PackedNumbers packed = pack_reals(cases[c]);
    EXPECT_EQ(packed.form, forms[c]) << c;
    const PackedView view{packed.count, packed.form, packed.width, packed.differences, packed.decimals, packed.bytes};
    const std::vector<double> back = unpack_reals(view, cases[c].size(), "x");
    ASSERT_EQ(back.size(), cases[c].size());
    EXPECT_TRUE(std::equal(back.begin(), back.end(), cases[c].begin(), same_bits)) << c;
    EXPECT_THROW(unpack_reals(view, cases[c].size() + 1, "x"), CannotRead);
  }
}

RC_GTEST_PROP(NumbersProperty, IntegersComeBack, (const std::vector<std::int64_t>& values)) {
  const PackedNumbers packed = pack_integers(values);
  RC_ASSERT(
      unpack_integers({packed.count, packed.form, packed.width, packed.differences, packed.decimals, packed.bytes},
                      values.size(), "x") == values);
}

}  // namespace
}  // namespace retalho
