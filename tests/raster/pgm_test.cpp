// ASCII PGM: what is one, and where it says that it is not.
#include "retalho/raster/pgm.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "retalho/core/error.h"
#include "retalho/raster/io.h"
#include "support/errors.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::holds;
using test::words_of;

/// The text in pieces of `piece` bytes, so that every number crosses a buffer's end some time.
Raster parse(const std::string& text, std::size_t piece = 1000) {
  std::size_t at = 0;
  return read_pgm(
      [&](char* to, std::size_t size) {
        const std::size_t n = std::min({size, piece, text.size() - at});
        std::copy_n(text.data() + at, n, to);
        at += n;
        return n;
      },
      "x.pgm");
}

std::vector<double> heights(const Raster& r) {
  std::vector<double> list;
  for (std::size_t k = 0; k < r.cells(); ++k) list.push_back(r.at(k));
  return list;
}

std::string refused(const std::string& text) {
  return words_of<CannotRead>([&] { parse(text); });
}

TEST(Pgm, AnyWhiteSpaceAndComments) {
  const std::vector<double> expected{1, 22, 333, 65535, 0, 6};
  for (const char* text : {"P2\n3 2\n65535\n1 22 333\n65535 0 6\n", "P2 3 2 65535 1 22 333 65535 0 6",
                           "P2\r\n3 2\r\n65535\r\n1 22 333\r\n65535 0 6\r\n",
                           "P2# made by hand\n# 9 9 9\n3 # columns\n2\t65535\n1\v22 333#x\n#\n65535\f0\n\n6 # end",
                           "P2\r3 2\r65535\r1 22 333\r65535 0 6", "P2\n3 2\n65535\n1\n22\n333\n65535\n0000\n00006"}) {
    for (std::size_t piece = 1; piece < 8; ++piece) {
      const Raster r = parse(text, piece);
      EXPECT_EQ(r.columns, 3);
      EXPECT_EQ(r.rows, 2);
      EXPECT_EQ(heights(r), expected) << text;
    }
  }
}

TEST(Pgm, LargeValuesStayExact) {
  EXPECT_TRUE(std::holds_alternative<std::vector<float>>(parse("P2 2 1 16777216 16777216 5").heights));
  const Raster r = parse("P2 2 1 9007199254740992 9007199254740991 16777217");
  EXPECT_EQ(heights(r), (std::vector<double>{9007199254740991.0, 16777217}));
}

TEST(Pgm, SaysWhereItIsWrong) {
  EXPECT_TRUE(holds(refused("P2\n3 2\n255\n1 2 3\n4 5\n"), "line 6: the file ends at sample 5 of 6 (column 2, row 1)"));
  EXPECT_TRUE(holds(refused("P2\n3 2\n255\n1 2 3\n4 -5 6\n"),
                    "line 5: the sample at column 1, row 1 should be a whole number"));
  EXPECT_TRUE(holds(refused("P2\n3 2\n255\n1 2 3\n4 5.5 6\n"), "'.'"));
  EXPECT_TRUE(holds(refused("P2\n3 2\n255\n1 2 x\n4 5 6\n"), "line 4: the sample at column 2, row 0"));
  EXPECT_TRUE(holds(refused("P2\n3 2\n255\n1 2 256\n4 5 6\n"), "above the largest value 255"));
  EXPECT_TRUE(holds(refused("P2\n3 2\n255\n1 2 3\n4 5 6\n7"), "line 6: something follows"));
  EXPECT_TRUE(holds(refused("P2\n3 2\n99999999999999999999\n"), "2^53"));
  EXPECT_TRUE(holds(refused("P2\n0 2\n255\n"), "the width is 0"));
  EXPECT_TRUE(holds(refused("P2\n3 99999999999\n255\n"), "the height is 99999999999"));
  EXPECT_TRUE(holds(refused("P2\n3 2\n0\n"), "maxval"));
  EXPECT_TRUE(holds(refused("P2\n3"), "ends before the height"));
  EXPECT_TRUE(holds(refused("P5\n3 2\n255\nabcdef"), "not an ASCII PGM"));
  EXPECT_TRUE(holds(refused(""), "not an ASCII PGM"));
  EXPECT_TRUE(holds(words_of<BadInput>([] { parse("P2 2000000000 2000000000 255 1 2"); }), "GB"));
}

TEST(Pgm, EveryPrefixIsRefused) {
  const std::string text = "P2 # note\n12 9\n3000\n";
  std::string samples;
  for (int k = 0; k < 12 * 9; ++k) samples += fmt::format("{}{}", 17 + k * 23, k % 12 == 11 ? "\n" : " ");
  const std::string whole = text + samples;
  EXPECT_EQ(parse(whole).cells(), 108U);
  // The last newline, and digits of the last number, may go without its being seen: text has no length of its own.
  for (std::size_t length = 0; length + 5 < whole.size(); ++length)
    EXPECT_THROW(parse(whole.substr(0, length)), CannotRead) << length;
}

TEST(Pgm, RandomDamageIsAnErrorOrAGrid) {
  test::Random random;
  const std::string whole = "P2\n4 3\n255\n1 2 3 4\n5 6 7 8\n9 10 11 12\n";
  int refusals = 0;
  for (int round = 0; round < 3000 * test::soak(); ++round) {
    std::string text = whole;
    for (std::size_t k = random.index(3) + 1; k-- > 0;)
      text[random.index(text.size())] = static_cast<char>(random.index(256));
    try {
      const Raster r = parse(text);
      ASSERT_EQ(heights(r).size(), r.cells());
    } catch (const Error& error) {
      ++refusals;
    }
  }
  EXPECT_GT(refusals, 500);
}

TEST(Pgm, ThroughReadRaster) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.put("x.pgm", "P2\n2 2\n255\n1 2\n3 4\n");
  ReadNotes notes;
  const Raster r = read_raster(file, {.nodata = 3.0}, &notes);
  EXPECT_EQ(notes.driver, "PGM (ASCII)");
  EXPECT_EQ(r.georef.unit, "unit");
  EXPECT_EQ(r.cell_width, 1);
  EXPECT_FALSE(r.valid(0, 1));
  EXPECT_EQ(summarize(r).valid, 3U);
  EXPECT_TRUE(holds(words_of<BadInput>([&] { read_raster(file, {.band = 2}); }), "one band"));
  EXPECT_TRUE(
      holds(words_of<CannotRead>([&] { read_raster(scratch.put("cut.pgm", "P2\n2 2\n255\n1 2\n3")); }), "cut.pgm"));
}

}  // namespace
}  // namespace retalho
