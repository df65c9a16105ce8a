// LAS: every point format, the CRS in both of its records, withheld points; every prefix of a file is refused.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>

#include "retalho/cloud/cloud.h"
#include "retalho/cloud/formats.h"
#include "retalho/core/error.h"
#include "support/errors.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::holds;
using test::words_of;

struct LasPoint {
  std::int32_t x, y, z;
  bool withheld = false;
};

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  if (bytes.size() < at + sizeof(T)) bytes.resize(at + sizeof(T), '\0');
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

constexpr std::size_t kLengths[]{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// A LAS file of these points: scales 0.01, 0.01, 0.001, offsets 500000, 4000000, 100. `record`: a variable length
/// record's id and bytes; `extra`: bytes behind each point's own.
std::string las_file(int format, const std::vector<LasPoint>& points, int minor, std::uint16_t id = 0,
                     const std::string& record = {}, std::size_t extra = 0) {
  const std::size_t header = minor >= 4 ? 375 : 227, length = kLengths[format] + extra;
  std::string bytes = "LASF";
  bytes.resize(header, '\0');
  put<std::uint8_t>(bytes, 24, 1);
  put<std::uint8_t>(bytes, 25, static_cast<std::uint8_t>(minor));
  put<std::uint16_t>(bytes, 94, static_cast<std::uint16_t>(header));
  if (id != 0) {
    std::string vlr(54, '\0');
    std::memcpy(vlr.data() + 2, "LASF_Projection", 15);
    put<std::uint16_t>(vlr, 18, id);
    put<std::uint16_t>(vlr, 20, static_cast<std::uint16_t>(record.size()));
    bytes += vlr + record;
    put<std::uint32_t>(bytes, 100, 1);
  }
  const std::size_t start = bytes.size();
  put<std::uint32_t>(bytes, 96, static_cast<std::uint32_t>(start));
  put<std::uint8_t>(bytes, 104, static_cast<std::uint8_t>(format));
  put<std::uint16_t>(bytes, 105, static_cast<std::uint16_t>(length));
  if (minor >= 4)
    put<std::uint64_t>(bytes, 247, points.size());
  else
    put<std::uint32_t>(bytes, 107, static_cast<std::uint32_t>(points.size()));
  const double scale[]{0.01, 0.01, 0.001}, offset[]{500000, 4000000, 100};
  for (std::size_t k = 0; k < 3; ++k) {
    put<double>(bytes, 131 + 8 * k, scale[k]);
    put<double>(bytes, 155 + 8 * k, offset[k]);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t at = start + i * length;
    put<std::int32_t>(bytes, at, points[i].x);
    put<std::int32_t>(bytes, at + 4, points[i].y);
    put<std::int32_t>(bytes, at + 8, points[i].z);
    put<std::uint8_t>(bytes, at + 15, points[i].withheld ? (format < 6 ? 0x80 : 0x04) : (format < 6 ? 0x02 : 0x01));
    bytes.resize(at + length, '\0');
  }
  return bytes;
}

const std::vector<LasPoint> kPoints{{100, 200, 3000}, {-100, 0, -1}, {7, 8, 9, true}, {12345, 54321, 0}};

TEST(Las, EveryPointFormatIsRead) {
  for (int format = 0; format <= 10; ++format)
    for (const std::size_t extra : {0, 5}) {
      PointCloud cloud;
      PointNotes notes;
      std::string crs;
      parse_las_points(las_file(format, kPoints, format >= 6 ? 4 : 2, 0, {}, extra), "x.las", cloud, notes, crs);
      ASSERT_EQ(cloud.positions.size(), 3U) << format;
      EXPECT_DOUBLE_EQ(cloud.positions[0].x, 500001);
      EXPECT_DOUBLE_EQ(cloud.positions[0].y, 4000002);
      EXPECT_DOUBLE_EQ(cloud.positions[0].z, 103);
      EXPECT_DOUBLE_EQ(cloud.positions[1].z, 99.999);
      EXPECT_DOUBLE_EQ(cloud.positions[2].x, 500123.45);
      ASSERT_EQ(notes.remarks.size(), 1U);
      EXPECT_TRUE(holds(notes.remarks[0], "1 points that the file withholds"));
      EXPECT_TRUE(crs.empty());
    }
}

TEST(Las, TheCrsComesFromItsRecords) {
  PointCloud cloud;
  PointNotes notes;
  std::string crs;
  parse_las_points(las_file(6, kPoints, 4, 2112, std::string("LOCAL_CS[\"here\"]\0", 17)), "x.las", cloud, notes, crs);
  EXPECT_EQ(crs, "LOCAL_CS[\"here\"]");
  std::string keys;
  const std::uint16_t words[]{1, 1, 0, 2, 2048, 0, 1, 4326, 3072, 0, 1, 25832};
  for (std::size_t i = 0; i < 12; ++i) put(keys, 2 * i, words[i]);
  parse_las_points(las_file(1, kPoints, 2, 34735, keys), "x.las", cloud, notes, crs);
  EXPECT_EQ(crs, "EPSG:25832");

  const test::ScratchFolder folder;
  const std::string file = folder.put("survey.las", las_file(1, kPoints, 2, 34735, keys));
  const PointCloud read = read_points(file, {}, &notes);
  EXPECT_TRUE(is_point_file(file));
  EXPECT_TRUE(holds(notes.crs_name, "EPSG:25832"));
  const Vec2 at = read.georef.to_crs({read.positions[0].x, read.positions[0].y});
  EXPECT_DOUBLE_EQ(at.x, 500001);
  EXPECT_DOUBLE_EQ(at.y, 4000002);
}

TEST(Las, EveryPrefixIsRefused) {
  const std::string whole = las_file(3, kPoints, 2);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    PointCloud cloud;
    PointNotes notes;
    std::string crs;
    EXPECT_THROW(parse_las_points(whole.substr(0, n), "x.las", cloud, notes, crs), CannotRead) << n;
    EXPECT_TRUE(cloud.positions.empty());
  }
}

TEST(Las, SaysWhatIsWrong) {
  const auto message = [](const std::string& bytes) {
    PointCloud cloud;
    PointNotes notes;
    std::string crs;
    return words_of<CannotRead>([&] { parse_las_points(bytes, "x.las", cloud, notes, crs); });
  };
  const std::string good = las_file(1, kPoints, 2);
  std::string bad = good;
  put<std::uint8_t>(bad, 104, 0x81);
  EXPECT_TRUE(holds(message(bad), "LAZ"));
  bad = good;
  put<std::uint8_t>(bad, 104, 11);
  EXPECT_TRUE(holds(message(bad), "point format 11"));
  bad = good;
  put<std::uint16_t>(bad, 105, 27);
  EXPECT_TRUE(holds(message(bad), "damaged"));
  bad = good;
  put<std::uint32_t>(bad, 107, 4000000000U);  // a claim of 112 GB: refused before it is asked for
  EXPECT_TRUE(holds(message(bad), "cut off"));
  bad = good;
  put<double>(bad, 131, 0.0);
  EXPECT_TRUE(holds(message(bad), "scale 0"));
  bad = good;
  put<double>(bad, 171, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(holds(message(bad), "of coordinate z"));
  EXPECT_TRUE(holds(message("PLAS" + good.substr(4)), "no LAS file"));
}

}  // namespace
}  // namespace retalho
