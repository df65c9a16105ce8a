// Points as text: every way of writing a table of x, y, z, and where it is none.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "retalho/cloud/cloud.h"
#include "retalho/cloud/formats.h"
#include "retalho/core/error.h"
#include "support/errors.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::holds;
using test::words_of;

struct Parsed {
  PointCloud cloud;
  PointNotes notes;
};

Parsed parse(const std::string& text) {
  Parsed parsed;
  parse_text_points(text, "x.txt", parsed.cloud, parsed.notes);
  return parsed;
}

const std::vector<Vec3> kThree{{1, 2, 3}, {-4.5, 5e3, 6.25}, {7, 8, -9}};

TEST(TextPoints, SeparatorsLineEndsAndSigns) {
  for (const char* text : {"1 2 3\n-4.5 5e3 6.25\n7 8 -9\n", "1,2,3\n-4.5,5e3,6.25\n7,8,-9",
                           "1;2;3\r\n-4.5;5e3;6.25\r\n7;8;-9\r\n", "1\t2\t3\n-4.5\t5E+3\t6.25\n7\t8\t-9\n",
                           "  1   2\t3  \n\n -4.5 5e3 6.25\n7 8 -9", "1, 2, 3\n-4.5, 5000, +6.25\n7, 8, -9\n",
                           "\xEF\xBB\xBF"
                           "1,2,3\n-4.5,5e3,6.25\n7,8,-9\n",
                           "1,2,3,\n-4.5,5e3,6.25,\n7,8,-9,\n", "1 2 3\r-4.5 5e3 6.25\r7 8 -9\r",
                           "\"1\",\"2\",\"3\"\n\"-4.5\",\"5e3\",\"6.25\"\n\"7\",\"8\",\"-9\"\n"}) {
    const Parsed p = parse(text);
    EXPECT_EQ(p.cloud.positions, kThree) << text;
    EXPECT_TRUE(p.cloud.normals.empty());
    EXPECT_EQ(p.notes.skipped, 0U);
  }
}

TEST(TextPoints, CommentsHeadersAndCounts) {
  for (const char* text : {"# a note\n1 2 3 # here\n% more\n-4.5 5e3 6.25\n> segment\n// and\n7 8 -9\n",
                           "x y z\n1 2 3\n-4.5 5e3 6.25\n7 8 -9\n", "3\n1 2 3\n-4.5 5e3 6.25\n7 8 -9\n",
                           "Soundings of 1998\nship A\nX;Y;Z\n1;2;3\n-4.5;5e3;6.25\n7;8;-9\n"})
    EXPECT_EQ(parse(text).cloud.positions, kThree) << text;
}

TEST(TextPoints, NamedColumnsInAnyOrderAmongOthers) {
  const Parsed p = parse("id,Elevation,\"Longitude\",name,LATITUDE\n1,3,1,a b,2\n2,6.25,-4.5,,5e3\n3,-9,7,\"c\",8\n");
  EXPECT_EQ(p.cloud.positions, kThree);
  EXPECT_TRUE(holds(p.notes.columns, "5 columns"));
  EXPECT_EQ(parse("#z x y\n3 1 2\n6.25 -4.5 5e3\n-9 7 8\n").cloud.positions, kThree);
}

TEST(TextPoints, NormalsWhereTheyAreNamedOrUnit) {
  const Parsed unit = parse("1 2 3 0 0 1\n4 5 6 0.6 0.8 0\n");
  EXPECT_EQ(unit.cloud.normals, (std::vector<Vec3>{{0, 0, 1}, {0.6, 0.8, 0}}));
  EXPECT_TRUE(parse("1 2 3 255 0 17\n4 5 6 0 0 1\n").cloud.normals.empty()) << "colours";
  EXPECT_TRUE(parse("1 2 3 a b c\n4 5 6 d e f\n").cloud.normals.empty()) << "words";
  const Parsed named = parse("x,y,z,nx,ny,nz\n1,2,3,0,0,5\n");
  EXPECT_EQ(named.cloud.normals, (std::vector<Vec3>{{0, 0, 5}}));
  EXPECT_EQ(parse("1 2 3 0 0 1\n4 5 6 0 0 3\n7 8 9 x 0 0\n").cloud.positions.size(), 3U);
}

TEST(TextPoints, NotFiniteIsLeftOutAndSaid) {
  const Parsed p = parse("1 2 3\n4 5 nan\n-4.5 5e3 6.25\ninf 1 1\nNA 1 1\n1 1 1e999\n7 8 -9\n");
  EXPECT_EQ(p.cloud.positions, kThree);
  EXPECT_EQ(p.notes.skipped, 4U);
  ASSERT_EQ(p.notes.remarks.size(), 1U);
  EXPECT_TRUE(holds(p.notes.remarks[0], "4 lines"));
  EXPECT_TRUE(holds(p.notes.remarks[0], "line 2"));
  EXPECT_EQ(parse("x,y,z\n1,2,3\n4,5,\n").notes.skipped, 1U) << "an empty field at the end";
  EXPECT_EQ(parse("x,y,z\n1,2,3\n4,,6\n").notes.skipped, 1U);
  EXPECT_EQ(parse("1 2 1e-999\n").cloud.positions, (std::vector<Vec3>{{1, 2, 0}}));
}

TEST(TextPoints, DecimalCommasAreRefusedByName) {
  for (const char* text :
       {"1,5;2,5;3,5\n", "x;y;z\n1,5;2,5;3,5\n", "1,5 2,5 3,5\n", "1,5\t2,5\t3,5\n", "1;2;3\n1,5;2,5;3,5\n"}) {
    const std::string words = words_of<BadInput>([&] { parse(text); });
    EXPECT_TRUE(holds(words, "decimal comma")) << text;
    EXPECT_TRUE(holds(words, "1.5"));
  }
}

TEST(TextPoints, SaysWhereItIsWrong) {
  EXPECT_TRUE(holds(words_of<CannotRead>([] { parse("1 2 3\n4 5\n"); }), "line 2: 2 values"));
  EXPECT_TRUE(holds(words_of<CannotRead>([] { parse("1 2 3\n4 five 6\n"); }), "line 2: 'five' is not a number"));
  EXPECT_TRUE(holds(words_of<CannotRead>([] { parse("1 2 3\n4 5 6 7\n"); }), "line 2: 4 values"));
  EXPECT_TRUE(holds(words_of<CannotRead>([] { parse("1 2 3\n4 5 0x10\n"); }), "0x10"));
  EXPECT_TRUE(holds(words_of<BadInput>([] { parse("1 2\n3 4\n"); }), "line 1: two numbers"));
  EXPECT_TRUE(holds(words_of<BadInput>([] { parse("# nothing\n\n"); }), "no line with three numbers"));
  EXPECT_TRUE(holds(words_of<BadInput>([] { parse(""); }), "no line"));
  EXPECT_TRUE(holds(words_of<CannotRead>([] {
                      parse(
                          std::string("\xFF\xFE"
                                      "1\0 \0",
                                      6));
                    }),
                    "UTF-16"));
  EXPECT_TRUE(holds(words_of<CannotRead>([] { parse(std::string("1 2 3\0", 6)); }), "not text"));
}

TEST(TextPoints, RandomDamageIsAnErrorOrPoints) {
  test::Random random;
  const std::string whole = "x;y;z\n1.5;2.5;3\n4;5;6\n7;8e1;9\n";
  for (int round = 0; round < 5000 * test::soak(); ++round) {
    std::string text = whole;
    for (std::size_t k = random.index(4) + 1; k-- > 0;)
      text[random.index(text.size())] = "0;,. \n\tx-+e#\"\0\xFF"[random.index(16)];
    try {
      for (const Vec3& p : parse(text).cloud.positions)
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    } catch (const Error& error) {
      ASSERT_TRUE(error.kind() == Error::Kind::bad_input || error.kind() == Error::Kind::cannot_read);
    }
  }
}

TEST(ReadPoints, MillimetresFarOutAreKept) {
  const test::ScratchFolder scratch;
  std::string text;
  for (int k = 0; k < 1000; ++k)
    text += fmt::format("{:.3f} {:.3f} {:.3f}\n", 4512345.678 + k * 0.001, 5712345.001 + k * 0.002, 100 + k * 0.001);
  PointNotes notes;
  const PointCloud cloud = read_points(scratch.put("x.xyz", text), {.crs = "EPSG:25832"}, &notes);
  ASSERT_EQ(cloud.positions.size(), 1000U);
  EXPECT_NE(cloud.georef.origin_x, 0);
  EXPECT_EQ(cloud.georef.origin_x, std::round(cloud.georef.origin_x));
  EXPECT_EQ(notes.crs_name, "EPSG:25832 ETRS89 / UTM zone 32N");
  EXPECT_EQ(cloud.georef.unit, "metre");
  for (std::size_t k = 0; k < 1000; ++k) {
    const double x = std::stod(fmt::format("{:.3f}", 4512345.678 + static_cast<double>(k) * 0.001));
    EXPECT_EQ(cloud.positions[k].x + cloud.georef.origin_x, x) << "the subtraction is exact";
    EXPECT_LT(std::abs(cloud.positions[k].x), 2);
  }
}

TEST(ReadPoints, SmallCoordinatesStayAsTheyAre) {
  const test::ScratchFolder scratch;
  const PointCloud cloud = read_points(scratch.put("x.xyz", "1 2 3\n4 5 6\n7 9 8\n"));
  EXPECT_EQ(cloud.georef.origin_x, 0);
  EXPECT_EQ(cloud.positions[1], (Vec3{4, 5, 6}));
  EXPECT_EQ(cloud.georef.unit, "unit");
}

TEST(ReadPoints, GeographicPointsBecomeMetres) {
  const test::ScratchFolder scratch;
  PointNotes notes;
  const PointCloud cloud =
      read_points(scratch.put("x.csv", "lon,lat,z\n7,47,1\n8,49,2\n7.5,48,3\n"), {.crs = "EPSG:4326"}, &notes);
  EXPECT_TRUE(cloud.georef.geographic);
  EXPECT_NEAR(cloud.positions[1].x - cloud.positions[0].x, 74628, 30);
  EXPECT_NEAR(cloud.positions[1].y - cloud.positions[0].y, 222398, 60);
  const Vec2 back = cloud.georef.to_crs({cloud.positions[0].x, cloud.positions[0].y});
  EXPECT_NEAR(back.x, 7, 1e-13);
  EXPECT_NEAR(back.y, 47, 1e-13);
  EXPECT_TRUE(holds(describe(cloud, notes, summarize(cloud)), "x 7 to 8, y 47 to 49, z 1 to 3, EPSG:4326 WGS 84"));
  EXPECT_TRUE(holds(words_of<BadInput>([&] { read_points(scratch / "x.csv", {.crs = "nonsense"}); }), "not a CRS"));
}

TEST(ReadPoints, MissingFoldersAndForeign) {
  const test::ScratchFolder scratch;
  EXPECT_THROW(read_points(scratch / "none.xyz"), CannotRead);
  EXPECT_THROW(read_points(scratch / "none.ply"), CannotRead);
  EXPECT_THROW(read_points(scratch / "none.gpkg"), CannotRead);
  EXPECT_THROW(read_points(scratch.path().string()), CannotRead);
  EXPECT_THROW(read_points(scratch.put("x.gpkg", "no package")), CannotRead);
  EXPECT_THROW(read_points(scratch.put("x.xyz", "")), BadInput);
  EXPECT_TRUE(
      holds(words_of<BadInput>([&] { read_points(scratch.put("x.xyz", "nan nan nan\n")); }), "1 were left out"));
}

TEST(ReadPoints, RealFiles) {
  struct Known {
    const char* file;
    std::size_t points;
    bool normals;
  };
  for (const Known& known :
       {Known{"points/oni.xyz", 1435, true}, Known{"points/hand.xyz", 52398, true},
        Known{"points/bunny.ply", 60000, true}, Known{"points/armadillo_nonormals.ply", 40000, false},
        Known{"dem/tut_ship.xyz", 82970, false}}) {
    RETALHO_DATA_FILE(file, known.file);
    const PointCloud cloud = read_points(file);
    EXPECT_EQ(cloud.positions.size(), known.points);
    EXPECT_EQ(cloud.normals.size(), known.normals ? known.points : 0);
    for (const Vec3& n : cloud.normals) ASSERT_NEAR(norm(n), 1, 1e-3);
  }
}

}  // namespace
}  // namespace retalho
