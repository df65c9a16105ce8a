// Rasters that are written are complete, and come back to the last bit.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "raster/synthetic.h"
#include "retalho/core/error.h"
#include "retalho/raster/io.h"
#include "support/errors.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::holds;
using test::words_of;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <class Height>
Raster random_raster(int columns, int rows, double void_share, test::Random& random) {
  Raster r;
  r.columns = columns;
  r.rows = rows;
  std::vector<Height> heights(r.cells());
  for (Height& h : heights)
    h = random.chance(void_share) ? static_cast<Height>(kNaN) : static_cast<Height>(random.uniform(-1e3, 1e4));
  if (heights.size() > 3) {
    heights[0] = std::numeric_limits<Height>::denorm_min();
    heights[1] = std::numeric_limits<Height>::max();
    heights[2] = static_cast<Height>(-0.0);
  }
  r.heights = std::move(heights);
  return r;
}

/// Bit for bit; any NaN for any NaN.
testing::AssertionResult same_bits(const Raster& a, const Raster& b) {
  if (a.columns != b.columns || a.rows != b.rows) return testing::AssertionFailure() << "sizes differ";
  for (std::size_t k = 0; k < a.cells(); ++k) {
    const double x = a.at(k), y = b.at(k);
    if (std::isnan(x) && std::isnan(y)) continue;
    if (std::bit_cast<std::uint64_t>(x) != std::bit_cast<std::uint64_t>(y))
      return testing::AssertionFailure() << "cell " << k << ": " << x << " and " << y;
  }
  return testing::AssertionSuccess();
}

TEST(WriteRaster, GeoTiffComesBackToTheLastBit) {
  const test::ScratchFolder scratch;
  test::Random random;
  for (const auto& [columns, rows] : {std::pair{1, 1}, std::pair{7, 3}, std::pair{300, 270}, std::pair{1000, 2}})
    for (const bool wide : {false, true}) {
      Raster r =
          wide ? random_raster<double>(columns, rows, 0.2, random) : random_raster<float>(columns, rows, 0.2, random);
      r.cell_width = 30;
      r.cell_height = 20;
      r.georef.origin_x = 500015.5;
      r.georef.origin_y = 4100012.25;
      r.height_unit = "m";
      OGRSpatialReference crs;
      crs.importFromEPSG(32611);
      char* wkt = nullptr;
      crs.exportToWkt(&wkt);
      r.georef.crs_wkt = wkt;
      CPLFree(wkt);
      const std::string file = scratch / "x.tif";
      write_raster(r, file, {.overwrite = true});
      ReadNotes notes;
      const Raster back = read_raster(file, {}, &notes);
      ASSERT_TRUE(same_bits(r, back));
      EXPECT_EQ(back.cell_width, 30);
      EXPECT_EQ(back.cell_height, 20);
      EXPECT_EQ(back.georef.origin_x, r.georef.origin_x);
      EXPECT_EQ(back.georef.origin_y, r.georef.origin_y);
      EXPECT_EQ(back.height_unit, "m");
      EXPECT_EQ(notes.crs_name, "EPSG:32611 WGS 84 / UTM zone 11N");
      EXPECT_TRUE(std::isnan(notes.nodata.value_or(0)));
      EXPECT_EQ(notes.data_type, wide ? "Float64" : "Float32");
      EXPECT_EQ(scratch.entries(), 1U);
    }
}

TEST(WriteRaster, GeographicPlacesComeBack) {
  const test::ScratchFolder scratch;
  const Raster r = read_raster(test::make_raster(
      scratch / "in.tif", {.transform = {7.123, 1.0 / 3600, 0, 48.015, 0, -1.0 / 3600}, .crs = "EPSG:4326"}));
  write_raster(r, scratch / "out.tif");
  const Raster back = read_raster(scratch / "out.tif");
  EXPECT_TRUE(back.georef.geographic);
  EXPECT_NEAR(back.georef.origin_x, r.georef.origin_x, 1e-14);
  EXPECT_NEAR(back.georef.origin_y, r.georef.origin_y, 1e-13);
  EXPECT_NEAR(back.cell_width / r.cell_width, 1, 1e-15);
  EXPECT_NEAR(back.cell_height / r.cell_height, 1, 1e-15);
}

TEST(WriteRaster, OtherFormatsByTheirEnding) {
  const test::ScratchFolder scratch;
  test::Random random;
  Raster r = random_raster<float>(20, 10, 0.3, random);
  std::get<std::vector<float>>(r.heights)[0] = -9999;  // so that -9999 cannot stand for the voids
  std::get<std::vector<float>>(r.heights)[1] = 17;
  for (const char* ending : {"asc", "img", "bil", "nc", "TIFF"}) {
    SCOPED_TRACE(ending);
    const std::string file = scratch / (std::string("x.") + ending);
    write_raster(r, file);
    ASSERT_TRUE(same_bits(r, read_raster(file)));
    EXPECT_THROW(write_raster(r, file), CannotWrite);
    write_raster(r, file, {.overwrite = true});
    ASSERT_TRUE(same_bits(r, read_raster(file)));
  }
  for (const auto& entry : std::filesystem::directory_iterator(scratch.path()))
    EXPECT_TRUE(entry.path().filename().string().starts_with("x.")) << entry.path() << " is left over";
}

TEST(WriteRaster, RefusesWhatItCannotDoAndLeavesNothing) {
  const test::ScratchFolder scratch;
  test::Random random;
  const Raster r = random_raster<float>(20, 10, 0.3, random);
  const auto refused = [&](const std::string& name, const WriteOptions& options = {}) {
    return words_of<CannotWrite>([&] { write_raster(r, scratch / name, options); });
  };
  EXPECT_TRUE(holds(refused("x.nothing"), "ending 'nothing'"));
  EXPECT_TRUE(holds(refused("x"), "ending ''"));
  EXPECT_TRUE(holds(refused("x.png"), "PNG"));
  EXPECT_TRUE(holds(refused("x.xyz"), "no-data")) << "a format that cannot tell voids from heights";
  EXPECT_TRUE(holds(refused("x.tif", {.driver = "NoSuch"}), "NoSuch"));
  EXPECT_TRUE(holds(refused("x.tif", {.creation_options = {"COMPRESS=NONSENSE"}}), "x.tif"));
  EXPECT_TRUE(holds(refused("no/such/folder/x.tif"), "folder"));
  EXPECT_THROW(write_raster(Raster{}, scratch / "x.tif"), CannotWrite);
  EXPECT_EQ(scratch.entries(), 0U);
}

TEST(WriteRaster, AnOldFilesCompanionsAreNotKept) {
  const test::ScratchFolder scratch;
  test::Random random;
  const Raster r = random_raster<float>(20, 10, 0.3, random);
  scratch.put("x.tif.aux.xml", "<PAMDataset/>");
  EXPECT_TRUE(holds(words_of<CannotWrite>([&] { write_raster(r, scratch / "x.tif"); }), "x.tif.aux.xml"));
  write_raster(r, scratch / "x.tif", {.overwrite = true});
  EXPECT_EQ(scratch.entries(), 1U);
}

TEST(WriteRaster, AFullDiskIsAnErrorAndLeavesTheOldFile) {
  // A limit on the size of files stands for the full disk. At every limit the file is whole or there is an error.
  const test::ScratchFolder scratch;
  test::Random random;
  const Raster r = random_raster<float>(200, 150, 0.1, random);
  write_raster(r, scratch / "whole.tif");
  const auto size = static_cast<rlim_t>(std::filesystem::file_size(scratch / "whole.tif"));
  scratch.put("x.tif", "the old one");
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  int refused = 0, limits = 0;
  for (rlim_t limit = 0; limit < size; limit += 1 + size / 40) {
    const rlimit tight{limit, old.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
    std::string words;
    try {
      write_raster(r, scratch / "x.tif", {.overwrite = true});
    } catch (const CannotWrite& error) {
      words = error.what();
      ++refused;
    }
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
    ++limits;
    if (words.empty())
      ASSERT_TRUE(same_bits(r, read_raster(scratch / "x.tif"))) << "limit " << limit << " of " << size;
    else
      ASSERT_TRUE(holds(words, "x.tif"));
  }
  EXPECT_EQ(refused, limits);
  EXPECT_EQ(test::bytes_of(scratch / "x.tif"), "the old one");
  EXPECT_EQ(scratch.entries(), 2U);
}

TEST(WriteRaster, StopsWhenAskedAndLeavesNothing) {
  const test::ScratchFolder scratch;
  test::Random random;
  const Raster r = random_raster<float>(200, 150, 0.1, random);
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  EXPECT_THROW(write_raster(r, scratch / "x.tif", {}, context), Interrupted);
  EXPECT_EQ(scratch.entries(), 0U);
}

}  // namespace
}  // namespace retalho
