// PLY in its three encodings, with whatever else the file holds; every prefix of it is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "retalho/cloud/cloud.h"
#include "retalho/cloud/formats.h"
#include "retalho/core/error.h"
#include "support/errors.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::holds;
using test::words_of;

enum class Encoding { ascii, little, big };

/// Appends values to a PLY body in one encoding.
class Writer {
 public:
  explicit Writer(Encoding encoding) : encoding_(encoding) {}
  template <class T>
  void put(T value) {
    if (encoding_ == Encoding::ascii) {
      bytes += fmt::format("{} ", value);
      return;
    }
    std::string raw(sizeof(T), '\0');
    std::memcpy(raw.data(), &value, sizeof(T));
    if ((encoding_ == Encoding::big) == (std::endian::native == std::endian::little))
      std::reverse(raw.begin(), raw.end());
    bytes += raw;
  }
  void end_line() {
    if (encoding_ == Encoding::ascii) bytes += "\n";
  }
  std::string bytes;

 private:
  Encoding encoding_;
};

const char* format_name(Encoding encoding) {
  return encoding == Encoding::ascii    ? "ascii"
         : encoding == Encoding::little ? "binary_little_endian"
                                        : "binary_big_endian";
}

/// Vertices between other elements and properties of all types, coordinates as double (or float), with normals.
std::string rich_file(Encoding encoding, const std::vector<Vec3>& points, bool wide, const char* line_end = "\n") {
  const std::string real = wide ? "double" : "float";
  std::string header;
  for (const std::string& line : {std::string("ply"),
                                  fmt::format("format {} 1.0", format_name(encoding)),
                                  std::string("comment made by a test"),
                                  std::string("obj_info none"),
                                  std::string("element camera 2"),
                                  std::string("property uchar kind"),
                                  std::string("property list uint8 float32 matrix"),
                                  fmt::format("element vertex {}", points.size()),
                                  std::string("property ushort id"),
                                  "property " + real + " x",
                                  "property " + real + " y",
                                  std::string("property list uchar int tags"),
                                  "property " + real + " z",
                                  std::string("property float nx"),
                                  std::string("property float ny"),
                                  std::string("property float nz"),
                                  std::string("property char last"),
                                  std::string("element face 1"),
                                  std::string("property list uchar int vertex_indices"),
                                  std::string("end_header")})
    header += line + line_end;
  Writer w(encoding);
  for (int k = 0; k < 2; ++k) {
    w.put(static_cast<std::uint8_t>(k));
    w.put(static_cast<std::uint8_t>(3));
    for (int j = 0; j < 3; ++j) w.put(static_cast<float>(j) + 0.5F);
    w.end_line();
  }
  const auto real_value = [&](double v) {
    if (wide)
      w.put(v);
    else
      w.put(static_cast<float>(v));
  };
  for (std::size_t k = 0; k < points.size(); ++k) {
    w.put(static_cast<std::uint16_t>(k));
    real_value(points[k].x);
    real_value(points[k].y);
    w.put(static_cast<std::uint8_t>(k % 3));
    for (std::size_t j = 0; j < k % 3; ++j) w.put(static_cast<std::int32_t>(-7));
    real_value(points[k].z);
    w.put(0.0F);
    w.put(0.6F);
    w.put(0.8F);
    w.put(static_cast<std::int8_t>(-1));
    w.end_line();
  }
  w.put(static_cast<std::uint8_t>(3));
  for (std::int32_t j = 0; j < 3; ++j) w.put(j);
  w.end_line();
  return header + w.bytes;
}

PointCloud parse(const std::string& bytes, PointNotes* notes = nullptr) {
  PointNotes own;
  PointCloud cloud;
  parse_ply_points(bytes, "x.ply", cloud, notes ? *notes : own);
  return cloud;
}

std::vector<Vec3> some_points(std::size_t count) {
  test::Random random;
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {random.uniform(4e6, 5e6), random.uniform(-1, 1), random.uniform() * 1e-3};
  return points;
}

TEST(PlyPoints, EveryEncodingToTheLastBit) {
  const std::vector<Vec3> points = some_points(20);
  for (const Encoding encoding : {Encoding::ascii, Encoding::little, Encoding::big}) {
    PointNotes notes;
    const PointCloud cloud = parse(rich_file(encoding, points, true), &notes);
    EXPECT_EQ(cloud.positions, points) << format_name(encoding);
    ASSERT_EQ(cloud.normals.size(), points.size());
    EXPECT_FLOAT_EQ(static_cast<float>(cloud.normals[7].z), 0.8F);
    EXPECT_TRUE(holds(notes.format, format_name(encoding)));
    ASSERT_EQ(notes.remarks.size(), 1U);
    EXPECT_TRUE(holds(notes.remarks[0], "1 faces"));
    // Text keeps the digits that are written, whatever type the header declares.
    const PointCloud narrow = parse(rich_file(encoding, points, false));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto expected = static_cast<float>(points[k].x);
      EXPECT_EQ(static_cast<float>(narrow.positions[k].x), expected);
      EXPECT_TRUE(encoding == Encoding::ascii || narrow.positions[k].x == static_cast<double>(expected));
    }
  }
  EXPECT_EQ(parse(rich_file(Encoding::ascii, points, true, "\r\n")).positions, points);
}

TEST(PlyPoints, EveryPrefixIsRefused) {
  const std::vector<Vec3> points = some_points(9);
  for (const Encoding encoding : {Encoding::ascii, Encoding::little, Encoding::big}) {
    const std::string whole = rich_file(encoding, points, true);
    const std::size_t face = encoding == Encoding::ascii ? 9 : 13;  // only vertices are read: the face may be cut
    ASSERT_EQ(parse(whole.substr(0, whole.size() - face)).positions.size(), 9U);
    // In text the cut may also fall behind a digit of the very last value, or the blanks after it.
    const std::size_t end = whole.size() - face - (encoding == Encoding::ascii ? 3 : 0);
    for (std::size_t length = 0; length < end; ++length)
      EXPECT_THROW(parse(whole.substr(0, length)), CannotRead) << length;
  }
}

TEST(PlyPoints, RandomDamageIsAnErrorOrPoints) {
  test::Random random;
  const std::vector<Vec3> points = some_points(9);
  for (const Encoding encoding : {Encoding::ascii, Encoding::little, Encoding::big}) {
    const std::string whole = rich_file(encoding, points, true);
    for (int round = 0; round < 3000 * test::soak(); ++round) {
      std::string bytes = whole;
      for (std::size_t k = random.index(3) + 1; k-- > 0;)
        bytes[random.index(bytes.size())] = static_cast<char>(random.index(256));
      try {
        for (const Vec3& p : parse(bytes).positions)
          ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      } catch (const Error& error) {
        ASSERT_TRUE(error.kind() == Error::Kind::bad_input || error.kind() == Error::Kind::cannot_read) << error.what();
      }
    }
  }
}

TEST(PlyPoints, SaysWhatIsWrong) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n";
  EXPECT_TRUE(holds(words_of<CannotRead>([] { parse("solid x\n"); }), "not a PLY"));
  EXPECT_TRUE(holds(words_of<CannotRead>([] { parse("ply\nformat ascii 1.0\n"); }), "no end_header"));
  EXPECT_TRUE(
      holds(words_of<CannotRead>([] { parse("ply\nformat utf 1.0\nend_header\n"); }), "line 2: unknown format 'utf'"));
  EXPECT_TRUE(holds(words_of<BadInput>([&] { parse(head + "end_header\n1 2 3 4\n"); }), "no property 'z'"));
  EXPECT_TRUE(holds(words_of<CannotRead>([&] { parse(head + "property float z\nend_header\n1 2 3\n4 five 6\n"); }),
                    "line 9: 'five'"));
  EXPECT_TRUE(holds(words_of<CannotRead>([&] { parse(head + "property list float int z\nend_header\n"); }), "line 6"));
  EXPECT_TRUE(
      holds(words_of<BadInput>([] { parse("ply\nformat ascii 1.0\nelement face 0\nend_header\n"); }), "no vertices"));
  const std::string many =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\nproperty float x\nproperty float "
      "y\nproperty float z\nend_header\n";
  EXPECT_TRUE(holds(words_of<CannotRead>([&] { parse(many + "123456789012"); }), "promises 4000000000000 vertices"));
  PointNotes notes;
  EXPECT_EQ(parse(head + "property float z\nend_header\n1 2 nan\n4 5 6\n", &notes).positions,
            (std::vector<Vec3>{{4, 5, 6}}));
  EXPECT_EQ(notes.skipped, 1U);
}

}  // namespace
}  // namespace retalho
