// What a raster file may say about its heights and its place, and what is made of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "raster/synthetic.h"
#include "retalho/core/error.h"
#include "retalho/raster/io.h"
#include "support/errors.h"
#include "support/paths.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::holds;
using test::MadeRaster;
using test::make_raster;
using test::words_of;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool is_float(const Raster& raster) {
  return std::holds_alternative<std::vector<float>>(raster.heights);
}

std::vector<double> heights(const Raster& raster) {
  std::vector<double> list;
  for (std::size_t k = 0; k < raster.cells(); ++k) list.push_back(raster.at(k));
  return list;
}

/// Equal, NaN equal to NaN.
testing::AssertionResult same(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return testing::AssertionFailure() << a.size() << " and " << b.size() << " values";
  for (std::size_t k = 0; k < a.size(); ++k)
    if (!(a[k] == b[k] || (std::isnan(a[k]) && std::isnan(b[k]))))
      return testing::AssertionFailure() << "value " << k << ": " << a[k] << " and " << b[k];
  return testing::AssertionSuccess();
}

class ReadRaster : public testing::Test {
 protected:
  std::string make(const MadeRaster& made, const std::string& name = "x.tif") const {
    return make_raster(scratch_ / name, made);
  }
  std::string refused(const MadeRaster& made) const {
    const std::string file = make(made);
    return words_of<BadInput>([&] { read_raster(file); });
  }
  test::ScratchFolder scratch_;
};

TEST_F(ReadRaster, PlaceAndSize) {
  ReadNotes notes;
  const Raster r = read_raster(make({.values = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}}), {}, &notes);
  EXPECT_EQ(r.columns, 4);
  EXPECT_EQ(r.rows, 3);
  EXPECT_EQ(r.cell_width, 10);
  EXPECT_EQ(r.cell_height, 10);
  EXPECT_EQ(r.georef.origin_x, 105);
  EXPECT_EQ(r.georef.origin_y, 495);
  EXPECT_EQ(r.georef.unit, "metre");
  EXPECT_FALSE(r.georef.geographic);
  EXPECT_TRUE(holds(r.georef.crs_wkt, "32611"));
  EXPECT_EQ(notes.crs_name, "EPSG:32611 WGS 84 / UTM zone 11N");
  EXPECT_EQ(notes.driver, "GTiff");
  EXPECT_EQ(notes.data_type, "Float32");
  EXPECT_EQ(notes.bands, 1);
  EXPECT_FALSE(notes.nodata.has_value());
  EXPECT_TRUE(notes.remarks.empty());
  EXPECT_TRUE(same(heights(r), {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
  EXPECT_EQ(describe(r, notes, summarize(r)),
            "4 x 3 cells of 10 x 10 metre, EPSG:32611 WGS 84 / UTM zone 11N, 12 valid (100 %), heights 1 to 12");
}

TEST_F(ReadRaster, SouthUpAndEastWestAreReordered) {
  const std::vector<double> file{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const Raster south = read_raster(make({.values = file, .transform = {100, 10, 0, 470, 0, 10}}));
  EXPECT_TRUE(same(heights(south), {9, 10, 11, 12, 5, 6, 7, 8, 1, 2, 3, 4}));
  EXPECT_EQ(south.georef.origin_y, 495);
  EXPECT_EQ(south.georef.origin_x, 105);
  const Raster west = read_raster(make({.values = file, .transform = {140, -10, 0, 500, 0, -10}}));
  EXPECT_TRUE(same(heights(west), {4, 3, 2, 1, 8, 7, 6, 5, 12, 11, 10, 9}));
  EXPECT_EQ(west.georef.origin_x, 105);
  EXPECT_EQ(west.georef.origin_y, 495);
}

TEST_F(ReadRaster, RotatedShearedAndSizelessAreRefused) {
  EXPECT_TRUE(holds(refused({.transform = {100, 10, 1, 500, 0, -10}}), "sheared"));
  EXPECT_TRUE(holds(refused({.transform = {100, 7, 7, 500, 7, -7}}), "rotated"));
  EXPECT_TRUE(holds(refused({.transform = {100, 0, 10, 500, 10, 0}}), "quarter turn"));
  const std::string flat = R"(<VRTDataset rasterXSize="2" rasterYSize="2"><GeoTransform>1,0,0,5,0,-1</GeoTransform>)"
                           R"(<VRTRasterBand dataType="Byte" band="1"/></VRTDataset>)";
  EXPECT_TRUE(holds(words_of<BadInput>([&] { read_raster(flat); }), "no size"));
  EXPECT_TRUE(holds(refused({.driver = "ENVI", .transform = {100, kNaN, 0, 500, 0, -10}}), "finite"));
}

TEST_F(ReadRaster, WithoutPlaceOrCrs) {
  ReadNotes notes;
  const Raster r = read_raster(make({.crs = "", .placed = false}), {}, &notes);
  EXPECT_EQ(r.cell_width, 1);
  EXPECT_EQ(r.cell_height, 1);
  EXPECT_EQ(r.georef.unit, "unit");
  EXPECT_EQ(r.georef.origin_x, 0);
  EXPECT_EQ(r.georef.crs_wkt, "");
  EXPECT_EQ(notes.crs_name, "");
  EXPECT_TRUE(holds(describe(r, notes, summarize(r)), "no CRS"));
}

TEST_F(ReadRaster, FeetAreNamed) {
  EXPECT_EQ(read_raster(make({.crs = "EPSG:2225"})).georef.unit, "US survey foot");
  EXPECT_EQ(read_raster(make({.crs = "EPSG:2256"})).georef.unit, "foot");
}

TEST_F(ReadRaster, GeographicDistancesAreMetresAtTheMeanLatitude) {
  ReadNotes notes;
  const Raster r = read_raster(make({.transform = {7, 0.01, 0, 48.015, 0, -0.01}, .crs = "EPSG:4326"}), {}, &notes);
  EXPECT_TRUE(r.georef.geographic);
  EXPECT_EQ(r.georef.unit, "metre");
  // The middle lies at 48 degrees: published lengths of a degree there (WGS 84).
  EXPECT_NEAR(r.cell_height, 1111.99, 0.3);
  EXPECT_NEAR(r.cell_width, 746.28, 0.3);
  // And by integrating the meridian with small steps of latitude: arc length from 47.5 to 48.5 degrees.
  const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
  double arc = 0;
  for (int k = 0; k < 1000; ++k) {
    const double s = std::sin((47.5 + (k + 0.5) / 1000) * std::numbers::pi / 180);
    arc += a * (1 - e2) / std::pow(1 - e2 * s * s, 1.5) * std::numbers::pi / 180 / 1000;
  }
  EXPECT_NEAR(r.georef.scale_y, arc, 0.01);
  ASSERT_EQ(notes.remarks.size(), 1U);
  EXPECT_TRUE(holds(notes.remarks[0], "latitude 48"));
  const Vec2 local = r.georef.to_local({7.005, 48.01});
  EXPECT_NEAR(local.x, 0, 1e-6);
  EXPECT_NEAR(local.y, 0, 1e-6);
  EXPECT_TRUE(holds(refused({.transform = {7, 0.01, 0, 4800, 0, -0.01}, .crs = "EPSG:4326"}), "latitude"));
}

TEST_F(ReadRaster, NoDataFromTagOptionAndNaN) {
  const std::vector<double> file{0, -9999, kNaN, 4, 5, 6, 7, 8, 9, 10, 11, 7};
  const auto tag = [](double value) { return [value](GDALDataset& d) { d.GetRasterBand(1)->SetNoDataValue(value); }; };
  ReadNotes notes;
  EXPECT_TRUE(
      same(heights(read_raster(make({.values = file}), {}, &notes)), {0, -9999, kNaN, 4, 5, 6, 7, 8, 9, 10, 11, 7}))
      << "NaN untagged";
  EXPECT_FALSE(notes.nodata.has_value());
  EXPECT_TRUE(same(heights(read_raster(make({.values = file, .more = tag(-9999)}), {}, &notes)),
                   {0, kNaN, kNaN, 4, 5, 6, 7, 8, 9, 10, 11, 7}));
  EXPECT_EQ(notes.nodata, -9999);
  EXPECT_TRUE(same(heights(read_raster(make({.values = file, .more = tag(kNaN)}))),
                   {0, -9999, kNaN, 4, 5, 6, 7, 8, 9, 10, 11, 7}));
  EXPECT_TRUE(same(heights(read_raster(make({.values = file, .more = tag(0)}), {.nodata = 7.0})),
                   {kNaN, -9999, kNaN, 4, 5, 6, kNaN, 8, 9, 10, 11, kNaN}))
      << "both";
  const RasterSummary s = summarize(read_raster(make({.values = file, .more = tag(-9999)})));
  EXPECT_EQ(s.cells, 12U);
  EXPECT_EQ(s.valid, 10U);
  EXPECT_EQ(s.minimum, 0);
  EXPECT_EQ(s.maximum, 11);
}

TEST_F(ReadRaster, NoDataIsComparedInTheStoredPrecision) {
  std::vector<double> file(12, 1.5);
  file[3] = -3.4028234663852886e38;
  const auto tag = [](GDALDataset& d) { d.GetRasterBand(1)->SetNoDataValue(-3.40282347e38); };  // larger than any float
  EXPECT_EQ(summarize(read_raster(make({.values = file, .more = tag}))).valid, 11U);
  file[3] = static_cast<double>(0.1F);
  EXPECT_EQ(summarize(read_raster(make({.values = file}), {.nodata = 0.1})).valid, 11U);
}

TEST_F(ReadRaster, InfiniteHeightsAreVoidAndCounted) {
  std::vector<double> file(12, 1.5);
  file[3] = std::numeric_limits<double>::infinity();
  file[4] = -file[3];
  for (const GDALDataType type : {GDT_Float32, GDT_Float64}) {
    ReadNotes notes;
    const Raster r = read_raster(make({.type = type, .values = file}), {}, &notes);
    EXPECT_EQ(summarize(r).valid, 10U);
    EXPECT_EQ(notes.infinite, 2U);
    ASSERT_EQ(notes.remarks.size(), 1U);
    EXPECT_TRUE(holds(notes.remarks[0], "2 infinite"));
  }
}

TEST_F(ReadRaster, AllVoidIsReadable) {
  const Raster r = read_raster(make({.values = std::vector<double>(12, kNaN)}));
  const RasterSummary s = summarize(r);
  EXPECT_EQ(s.valid, 0U);
  EXPECT_TRUE(std::isnan(s.minimum));
  EXPECT_TRUE(holds(describe(r, {}, s), "no valid cell"));
}

TEST_F(ReadRaster, ScaleAndOffset) {
  const auto scaled = [](double scale, double offset) {
    return [=](GDALDataset& d) {
      d.GetRasterBand(1)->SetScale(scale);
      d.GetRasterBand(1)->SetOffset(offset);
      d.GetRasterBand(1)->SetNoDataValue(-1);
    };
  };
  const std::vector<double> file{0, -1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  ReadNotes notes;
  const Raster r =
      read_raster(make({.type = GDT_Int16, .values = file, .more = scaled(0.1, -50)}), {.nodata = -49.0}, &notes);
  EXPECT_EQ(notes.scale, 0.1);
  EXPECT_EQ(notes.offset, -50);
  for (std::size_t k = 0; k < 12; ++k) {
    if (k == 1 || k == 10)
      EXPECT_TRUE(std::isnan(r.at(k))) << k;  // the tag is about stored values, the option about heights
    else
      EXPECT_EQ(r.at(k), static_cast<double>(k) * 0.1 - 50);
  }
  EXPECT_FALSE(is_float(r));
  EXPECT_TRUE(is_float(read_raster(make({.type = GDT_Int16, .values = file, .more = scaled(2, 100)}))));
  EXPECT_TRUE(holds(refused({.type = GDT_Int16, .values = file, .more = scaled(0, 1)}), "scale"));
}

TEST_F(ReadRaster, EveryTypeIsExact) {
  struct Case {
    GDALDataType type;
    std::vector<double> values;
    bool as_float;
  };
  const double big = 16777217, huge = 4294967295;
  for (const Case& c :
       {Case{GDT_Byte, {0, 1, 255, 4}, true}, Case{GDT_Int16, {-32768, 32767, 0, 1}, true},
        Case{GDT_UInt16, {0, 65535, 1, 2}, true}, Case{GDT_Int32, {-5, 16777216, 3, 4}, true},
        Case{GDT_Int32, {-5, 0, 3, big}, false}, Case{GDT_UInt32, {huge, 0, 1, 2}, false},
        Case{GDT_Float32, {0.1F, 1e30F, -3.5, 4}, true}, Case{GDT_Float64, {0.5, 0.25, -3, 4}, true},
        Case{GDT_Float64, {0.5, 0.25, -3, 0.1}, false}, Case{GDT_Int64, {-7, 9007199254740992.0, 3, 4}, true},
        Case{GDT_Int64, {-7, 9007199254740991.0, 3, 4}, false},
        Case{GDT_UInt64, {7, 9007199254740991.0, 3, 4}, false}}) {
    SCOPED_TRACE(GDALGetDataTypeName(c.type));
    ReadNotes notes;
    const Raster r = read_raster(make({.columns = 2, .rows = 2, .type = c.type, .values = c.values}), {}, &notes);
    EXPECT_TRUE(same(heights(r), c.values));
    EXPECT_EQ(is_float(r), c.as_float);
    EXPECT_EQ(notes.data_type, GDALGetDataTypeName(c.type));
  }
}

TEST_F(ReadRaster, SixtyFourBitNoDataIsExact) {
  const std::string file = scratch_ / "big.tif";
  GDALAllRegister();
  GDALDataset* d = GetGDALDriverManager()->GetDriverByName("GTiff")->Create(file.c_str(), 2, 1, 1, GDT_Int64, nullptr);
  const std::int64_t nodata = (std::int64_t{1} << 60) + 1;
  d->GetRasterBand(1)->SetNoDataValueAsInt64(nodata);
  std::array<std::int64_t, 2> values{nodata, nodata - 1};
  ASSERT_EQ(d->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 2, 1, values.data(), 2, 1, GDT_Int64, 0, 0, nullptr),
            CE_None);
  GDALClose(d);
  ReadNotes notes;
  const Raster r = read_raster(file, {}, &notes);
  EXPECT_FALSE(r.valid(0, 0));
  EXPECT_EQ(r.at(1, 0), std::pow(2.0, 60));
  ASSERT_EQ(notes.remarks.size(), 1U);
  EXPECT_TRUE(holds(notes.remarks[0], "2^53"));
}

TEST_F(ReadRaster, MaskAndAlphaBandsMakeVoids) {
  const auto masked = [](GDALDataset& d) {
    CPLSetThreadLocalConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES");
    ASSERT_EQ(d.CreateMaskBand(GMF_PER_DATASET), CE_None);
    std::vector<unsigned char> mask(12, 255);
    mask[5] = mask[11] = 0;
    ASSERT_EQ(
        d.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 4, 3, mask.data(), 4, 3, GDT_Byte, 0, 0, nullptr),
        CE_None);
  };
  const Raster r = read_raster(make({.values = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, .more = masked}));
  EXPECT_TRUE(same(heights(r), {1, 2, 3, 4, 5, kNaN, 7, 8, 9, 10, 11, kNaN}));
  const Mask mask = valid_mask(r);
  EXPECT_EQ(mask.count(), 10U);
  EXPECT_FALSE(mask.get(3, 2));
}

TEST_F(ReadRaster, ColourTableIsRemarkedComplexRefused) {
  const auto coloured = [](GDALDataset& d) {
    GDALColorTable table;
    const GDALColorEntry red{255, 0, 0, 255};
    table.SetColorEntry(1, &red);
    d.GetRasterBand(1)->SetColorTable(&table);
  };
  ReadNotes notes;
  read_raster(make({.type = GDT_Byte, .more = coloured}), {}, &notes);
  ASSERT_FALSE(notes.remarks.empty());
  EXPECT_TRUE(holds(notes.remarks[0], "colour table"));
  EXPECT_TRUE(holds(refused({.type = GDT_CFloat32}), "complex"));
}

TEST_F(ReadRaster, BandsAreChosenAndCounted) {
  const std::string file = scratch_ / "bands.tif";
  GDALAllRegister();
  GDALDataset* d = GetGDALDriverManager()->GetDriverByName("GTiff")->Create(file.c_str(), 2, 2, 3, GDT_Int16, nullptr);
  for (int b = 1; b <= 3; ++b) d->GetRasterBand(b)->Fill(b * 10);
  GDALClose(d);
  ReadNotes notes;
  EXPECT_EQ(read_raster(file, {.band = 3}, &notes).at(0), 30);
  EXPECT_EQ(notes.bands, 3);
  EXPECT_TRUE(holds(words_of<BadInput>([&] { read_raster(file, {.band = 4}); }), "bands 1 to 3"));
  EXPECT_TRUE(holds(words_of<BadInput>([&] { read_raster(file, {.band = 0}); }), "no band 0"));
}

TEST_F(ReadRaster, TiledCompressedAndLargerThanTheBuffer) {
  // 3000 columns x 1500 rows of float pass the reading buffer; tiles and strips must not show.
  MadeRaster made{.columns = 3000, .rows = 1500};
  for (int k = 0; k < made.columns * made.rows; ++k) made.values.push_back(k % 65521 - 0.5 * (k % 7));
  for (const std::vector<const char*>& options : {std::vector<const char*>{},
                                                  {"TILED=YES", "COMPRESS=DEFLATE"},
                                                  {"BLOCKYSIZE=1500"},
                                                  {"TILED=YES", "BLOCKXSIZE=1024", "BLOCKYSIZE=1024"}}) {
    made.options = options;
    ASSERT_TRUE(same(heights(read_raster(make(made))), made.values));
  }
  made.transform[5] = 10;
  std::vector<double> turned;
  for (int row = made.rows; row-- > 0;)
    turned.insert(turned.end(), made.values.begin() + row * made.columns,
                  made.values.begin() + (row + 1) * made.columns);
  ASSERT_TRUE(same(heights(read_raster(make(made))), turned));
}

TEST_F(ReadRaster, VrtAsTextAndAbsurdSizes) {
  const std::string vrt =
      R"(<VRTDataset rasterXSize="{0}" rasterYSize="{0}"><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>)";
  EXPECT_EQ(read_raster(fmt::format(fmt::runtime(vrt), 20)).cells(), 400U);
  const std::string words = words_of<BadInput>([&] { read_raster(fmt::format(fmt::runtime(vrt), 2000000)); });
  EXPECT_TRUE(holds(words, "16000.0 GB")) << words;
  EXPECT_TRUE(holds(words, "VRT given as text"));
  EXPECT_LT(words.size(), 400U);
}

TEST_F(ReadRaster, MissingEmptyFolderAndForeign) {
  EXPECT_TRUE(holds(words_of<CannotRead>([&] { read_raster(scratch_ / "none.tif"); }), "does not exist"));
  EXPECT_TRUE(holds(words_of<CannotRead>([&] { read_raster(scratch_.path().string()); }), "folder"));
  EXPECT_TRUE(holds(words_of<CannotRead>([&] { read_raster(scratch_.put("empty.tif", "")); }), "empty.tif"));
  EXPECT_TRUE(holds(words_of<CannotRead>([&] { read_raster(scratch_.put("words.tif", "no raster at all")); }),
                    "not recognized"));
  EXPECT_THROW(read_raster(""), CannotRead);
  EXPECT_THROW(read_raster("/vsizip/{/nowhere.zip}/x.tif"), CannotRead);
}

TEST_F(ReadRaster, EveryPrefixIsRefusedOrComplete) {
  // A cut file is an error; never a grid with made-up heights. (A cut behind the last byte that matters is whole.)
  for (const std::vector<const char*>& options :
       {std::vector<const char*>{}, {"COMPRESS=DEFLATE"}, {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16"}}) {
    MadeRaster made{.columns = 40, .rows = 30, .options = options};
    for (int k = 0; k < 1200; ++k) made.values.push_back(1 + k * 0.37);
    std::vector<double> stored;
    for (const double v : made.values) stored.push_back(static_cast<double>(static_cast<float>(v)));
    const std::string whole = test::bytes_of(make(made));
    int refused = 0, tried = 0;
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 50) {
      ++tried;
      const std::string file = scratch_.put("cut.tif", whole.substr(0, length));
      try {
        ASSERT_TRUE(same(heights(read_raster(file)), stored)) << length << " of " << whole.size();
      } catch (const CannotRead& error) {
        ASSERT_TRUE(holds(error.what(), "cut.tif"));
        ++refused;
      }
    }
    EXPECT_GT(refused, tried * 8 / 10);
  }
}

TEST_F(ReadRaster, FlippedBytesNeverEndTheProgram) {
  MadeRaster made{.columns = 40, .rows = 30, .options = {"COMPRESS=DEFLATE"}};
  for (int k = 0; k < 1200; ++k) made.values.push_back(1 + k * 0.37);
  const std::string whole = test::bytes_of(make(made));
  test::Random random;
  for (int round = 0; round < 300 * test::soak(); ++round) {
    std::string bytes = whole;
    bytes[random.index(round % 2 ? bytes.size() : 400)] = static_cast<char>(random.index(256));
    try {
      read_raster(scratch_.put("flipped.tif", bytes));
    } catch (const Error& error) {
      ASSERT_TRUE(error.kind() == Error::Kind::cannot_read || error.kind() == Error::Kind::bad_input) << error.what();
    }
  }
}

TEST_F(ReadRaster, ManyThreadsAtOnce) {
  const std::string file = make({.values = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}});
  std::vector<std::thread> threads;
  threads.reserve(8);
  std::atomic<int> good = 0;
  for (int k = 0; k < 8; ++k)
    threads.emplace_back([&] {
      for (int j = 0; j < 20; ++j) {
        good += read_raster(file).at(11) == 12;
        try {
          read_raster(scratch_ / "none.tif");
        } catch (const CannotRead&) {
          ++good;
        }
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(good, 8 * 40);
}

TEST_F(ReadRaster, StopsWhenAskedAndReportsProgress) {
  const std::string file = make({.columns = 2000, .rows = 2000});
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  EXPECT_THROW(read_raster(file, {}, nullptr, context), Interrupted);
  context.cancel = nullptr;
  double last = 0;
  context.progress = [&](std::string_view, double done) {
    EXPECT_GE(done, last);
    last = done;
  };
  read_raster(file, {}, nullptr, context);
  EXPECT_EQ(last, 1);
}

TEST(Jacksboro, ReadsFromTheDebianPackage) {
  const std::string archive = "/usr/share/matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz";
  if (!std::filesystem::exists(archive)) GTEST_SKIP() << "no " << archive << " (package python-matplotlib-data)";
  ReadNotes notes;
  const Raster r = read_raster(test::source_folder() + "/examples/jacksboro.vrt", {}, &notes);
  const RasterSummary s = summarize(r);
  EXPECT_EQ(r.rows, 344);
  EXPECT_EQ(r.columns, 403);
  EXPECT_EQ(notes.data_type, "Int16");
  EXPECT_EQ(s.valid, 344U * 403U);
  EXPECT_EQ(s.minimum, 236);
  EXPECT_EQ(s.maximum, 1076);
  EXPECT_EQ(notes.crs_name, "EPSG:4326 WGS 84");
  EXPECT_NEAR(r.cell_width, 74.57, 0.01);
  EXPECT_NEAR(r.cell_height, 92.48, 0.01);
}

}  // namespace
}  // namespace retalho
