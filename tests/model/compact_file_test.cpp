// The compact form as a file: what is read is what was written, to the bit; what was damaged is refused; and the fit
// that knows of the rounding keeps its promises on the file that is read back.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <set>

#include "identical.h"
#include "retalho/core/error.h"
#include "retalho/model/check.h"
#include "retalho/model/compact.h"
#include "retalho/model/compact_file.h"
#include "retalho/model/fit_source.h"
#include "retalho/model/model.h"
#include "retalho/raster/crs_code.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/report.h"
#include "support/grids.h"
#include "support/support.h"

namespace retalho {
namespace {

using greedy::Cell;
using greedy::cell_at;

/// Numbers out of a formula with noise, and what the coder made of them.
class NoisySource : public ValueSource {
 public:
  NoisySource(const std::vector<Cell>& cells, std::uint64_t seed, double rough) {
    std::mt19937_64 random(seed);
    const auto noise = [&] { return rough * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5); };
    for (const Cell c : cells) {
      const double x = greedy::column_of(c), y = greedy::row_of(c);
      heights.push_back(500 + 20 * std::sin(x / 7) + 3 * y + noise());
      gradients.push_back({20.0 / 7 * std::cos(x / 7) + noise(), -3 + noise()});
    }
  }
  void settle() override {}
  double height(std::uint32_t v) override { return heights[v]; }
  Vec2 gradient(std::uint32_t v) override { return gradients[v]; }
  void coded_height(std::uint32_t v, double z) override { heights[v] = z; }
  void coded_gradient(std::uint32_t v, Vec2 g) override { gradients[v] = g; }
  std::vector<double> heights;
  std::vector<Vec2> gradients;
};

struct Sample {
  CompactFrameFacts facts;
  std::vector<Cell> cells;
  std::vector<std::uint8_t> folded = {};
  std::uint64_t seed = 1;
  double rough = 1;

  CompactEncoding encode() const {
    NoisySource source(cells, seed, rough);
    return encode_compact(facts, cells, source, {}, folded);
  }
};

Sample sample(SurfaceKind kind, bool heights_only, bool masked) {
  Sample s;
  s.facts.kind = kind;
  s.facts.heights_only = heights_only;
  s.facts.georef = {123456.5, -0.25, 1, 1, "LOCAL_CS[\"sample\"]", "metre", false};
  s.facts.grid = {14, 11, 2, 2.5, {}};
  if (masked) {
    s.facts.grid.valid = Mask(14, 11, true);
    for (int k = 0; k < 9; ++k) s.facts.grid.valid.set(k, k / 2, false);
  }
  s.facts.tolerance = 0.5;
  s.facts.reference = 530;
  s.facts.steps.height = 0.4;
  s.cells = {cell_at(0, 0), cell_at(13, 0), cell_at(5, 3),  cell_at(9, 4),
             cell_at(6, 7), cell_at(0, 10), cell_at(13, 10)};
  std::sort(s.cells.begin(), s.cells.end());
  return s;
}

std::vector<Sample> samples() {
  std::vector<Sample> result{sample(SurfaceKind::linear, false, true), sample(SurfaceKind::clough_tocher, false, false),
                             sample(SurfaceKind::clough_tocher, true, true),
                             sample(SurfaceKind::clough_tocher, false, false)};
  result.back().folded = {0, 1, 1, 0, 0, 0, 1};
  return result;
}

TEST(CompactFile, SaysThatItIsOfTheFirstFormWhereNoVertexIsFolded) {
  Sample s = sample(SurfaceKind::clough_tocher, false, false);
  const std::string smooth = s.encode().bytes;
  s.folded.assign(s.cells.size(), 0);
  EXPECT_EQ(s.encode().bytes, smooth);
  EXPECT_EQ(smooth[4], 1);
  s.folded[3] = 1;
  const CompactEncoding folded = s.encode();
  EXPECT_EQ(folded.bytes[4], 2);
  EXPECT_FALSE(folded.terrain.creases.empty());
}

TEST(CompactFile, AllVerticesFoldedAreTheFlatSurface) {
  Sample s = sample(SurfaceKind::clough_tocher, false, false);
  s.folded.assign(s.cells.size(), 1);
  const Terrain folded = std::get<Terrain>(decode_model(s.encode().bytes));
  Terrain flat = folded;
  flat.kind = SurfaceKind::linear;
  flat.gradients.clear();
  flat.creases.clear();
  flat.corner_gradients.clear();
  const TerrainEvaluator a(folded), b(flat);
  for (double x = 0; x <= 26; x += 0.7)
    for (double y = -25; y <= 0; y += 0.9) EXPECT_NEAR(a.value({x, y}), b.value({x, y}), 1e-9);
}

TEST(CompactFile, EveryProperPrefixIsRefused) {
  for (const Sample& s : samples()) {
    const std::string bytes = s.encode().bytes;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const std::unique_ptr<char[]> exact(new char[size]);
      std::copy_n(bytes.begin(), size, exact.get());
      ASSERT_THROW(decode_model({exact.get(), size}), CannotRead) << size;
    }
    EXPECT_THROW(decode_model(bytes + '\0'), CannotRead);
  }
}

TEST(CompactFile, EveryChangedByteIsRefused) {
  for (const Sample& s : samples()) {
    const std::string bytes = s.encode().bytes;
    for (std::size_t at = 0; at < bytes.size(); ++at)
      for (int flip = 1; flip < 256; ++flip) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ flip);
        ASSERT_THROW(decode_model(changed), CannotRead) << at << " ^ " << flip;
      }
  }
}

/// With a checksum that fits.
std::string sealed_anew(std::string bytes) {
  if (bytes.size() < 10) return bytes;
  XXH64_state_t state;
  XXH64_reset(&state, 0);
  XXH64_update(&state, bytes.data(), 5);
  XXH64_update(&state, bytes.data() + 9, bytes.size() - 9);
  const auto sum = XXH64_digest(&state);
  for (std::size_t k = 0; k < 4; ++k) bytes[5 + k] = static_cast<char>(sum >> (8 * k) & 0xff);
  return bytes;
}

enum class Outcome { model, refused };
Outcome read(const std::string& bytes) {
  const std::unique_ptr<char[]> exact(new char[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  try {
    const Model model = decode_model({exact.get(), bytes.size()}, "m.retalho");
    EXPECT_EQ(find_fault(std::get<Terrain>(model)), "");
    return Outcome::model;
  } catch (const CannotRead& e) {
    EXPECT_GT(std::strlen(e.what()), 30U) << e.what();
    return Outcome::refused;
  }
}

TEST(CompactFile, AVersionThatDoesNotGoWithTheFoldsIsRefused) {
  for (const Sample& s : samples()) {
    std::string changed = s.encode().bytes;
    changed[4] = static_cast<char>(3 - changed[4]);
    try {
      decode_model(sealed_anew(changed));
      ADD_FAILURE() << "was read";
    } catch (const CannotRead& e) {
      EXPECT_NE(std::string(e.what()).find("the version is not the one of its kind of surface"), std::string::npos);
    }
  }
}

TEST(CompactFile, ChangesPastTheChecksumGiveAnErrorOrASoundModel) {
  std::size_t refused = 0, tried = 0;
  for (const Sample& s : samples()) {
    const std::string bytes = s.encode().bytes;
    for (std::size_t at = 10; at < bytes.size(); ++at)
      for (const int flip : {0x01, 0x10, 0x40, 0x80}) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ flip);
        // A grid of 2^28 cells is a grid: what it costs to read is known, and no fault.
        refused += read(sealed_anew(changed)) == Outcome::refused;
        ++tried;
      }
  }
  EXPECT_GT(refused, tried / 10) << "of " << tried;
  EXPECT_GT(tried - refused, tried / 10) << "of " << tried;
}

RC_GTEST_PROP(CompactFileProperty, WhatIsReadIsWhatWasWritten, ()) {
  Sample s = sample(*rc::gen::element(SurfaceKind::linear, SurfaceKind::clough_tocher), false, false);
  s.facts.heights_only = s.facts.kind == SurfaceKind::clough_tocher && *rc::gen::arbitrary<bool>();
  const int columns = *rc::gen::inRange(2, 70), rows = *rc::gen::inRange(2, 70);
  s.facts.grid = {columns, rows, *rc::gen::element(1.0, 0.5, 30.123456789), *rc::gen::element(1.0, 7.25), {}};
  if (*rc::gen::arbitrary<bool>()) {
    s.facts.grid.valid = Mask(columns, rows, true);
    for (int k = *rc::gen::inRange(0, 40); k > 0; --k)
      s.facts.grid.valid.set(*rc::gen::inRange(0, columns), *rc::gen::inRange(0, rows), false);
  }
  std::set<Cell> cells;
  for (int k = *rc::gen::inRange(3, 300); k > 0; --k)
    cells.insert(cell_at(*rc::gen::inRange(0, columns), *rc::gen::inRange(0, rows)));
  s.cells.assign(cells.begin(), cells.end());
  RC_PRE(s.cells.size() >= 3 && std::any_of(s.cells.begin(), s.cells.end(), [&](Cell c) {
           return greedy::area2(s.cells.front(), s.cells.back(), c) != 0;
         }));
  if (s.facts.kind == SurfaceKind::clough_tocher && !s.facts.heights_only)
    for (std::size_t k = *rc::gen::element(0, 1) * s.cells.size(); k > 0; --k)
      s.folded.push_back(*rc::gen::element<std::uint8_t>(0, 0, 1));
  s.facts.steps = {*rc::gen::element(1e-3, 0.37, 5.0, 4e4), static_cast<std::uint8_t>(*rc::gen::inRange(0, 17)),
                   static_cast<std::uint8_t>(*rc::gen::inRange(1, 60))};
  s.facts.reference = *rc::gen::element(0.0, 500.0, -12.5);
  s.rough = *rc::gen::element(0.0, 1.0, 1e4) * std::sqrt(s.facts.steps.height);
  s.seed = *rc::gen::arbitrary<std::uint64_t>();
  const CompactEncoding made = s.encode();
  const Terrain read = std::get<Terrain>(decode_model(made.bytes));
  RC_ASSERT(test::identical(read, made.terrain));
  RC_ASSERT(read.tin.vertex_count() == s.cells.size());
  // Heights within half a step of what was asked for: no step is coarser than that of a star of half a cell.
  const NoisySource source(s.cells, s.seed, s.rough);
  const double step = s.facts.steps.height * std::pow(2.0, (s.facts.steps.crowding + 1) / 16.0) * 1.1;
  for (std::size_t v = 0; v < s.cells.size(); ++v)
    RC_ASSERT(std::abs(read.tin.heights[v] - source.heights[v]) <= step / 2 + 1e-9);
  // And again: the same numbers on the same lattices give the same bytes.
  RC_ASSERT(s.encode().bytes == made.bytes);
}

TEST(CompactFile, KeepsWhereItLies) {
  Sample s = sample(SurfaceKind::clough_tocher, false, false);
  s.facts.georef = {-71.99986111111112, 45.00013888888889, 79000.25, 111131.5, "", "metre", true};
  for (const char* crs : {"", "EPSG:25832", "EPSG:4326"}) {
    if (*crs != '\0') s.facts.georef.crs_wkt = wkt_of_epsg(std::atoi(crs + 5));
    const CompactEncoding made = s.encode();
    EXPECT_TRUE(test::identical(std::get<Terrain>(decode_model(made.bytes)), made.terrain));
    EXPECT_EQ(made.terrain.georef.crs_wkt, s.facts.georef.crs_wkt);
    EXPECT_LT(made.bytes.size(), 200U) << crs;  // a code, not a kilobyte
  }
}

TEST(CompactFile, SaysWhatItCannotHold) {
  const auto refused = [](const auto& change) {
    Sample s = sample(SurfaceKind::clough_tocher, false, false);
    change(s);
    EXPECT_THROW(s.encode(), BadInput);
  };
  refused([](Sample& s) { s.facts.kind = SurfaceKind::powell_sabin; });
  refused([](Sample& s) { s.facts.steps.height = 0; });
  refused([](Sample& s) { s.facts.steps.height = std::nan(""); });
  refused([](Sample& s) { s.facts.grid.columns = 70000; });
  refused([](Sample& s) { s.facts.grid.cell_width = 0; });
  refused([](Sample& s) { s.facts.steps.height = 1e-9; });
  refused([](Sample& s) { s.cells = {cell_at(0, 0), cell_at(1, 1), cell_at(2, 2)}; });
}

Raster hills(int columns, int rows, bool voids) {
  return test::make_grid(columns, rows, [&](int x, int y) {
    if (voids && (x - 30) * (x - 30) + (y - 20) * (y - 20) < 50) return std::nan("");
    return 300 + 40 * std::sin(x / 9.0) * std::cos(y / 7.0) + 15 * std::sin(x * 0.31 + y * 0.17) +
           (x > 50 ? 25.0 : 0.0);
  });
}

TEST(CompactFit, TheFileReadBackIsWithinTheToleranceOfEveryCell) {
  for (const bool voids : {false, true})
    for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::clough_tocher})
      for (const double tolerance : {0.05, 1.0, 12.0, 400.0}) {
        const Raster raster = hills(80, 61, voids);
        const CompactModel model = fit_compact(raster, {.surface = kind, .max_error = tolerance});
        const Terrain read = std::get<Terrain>(decode_model(model.bytes));
        EXPECT_TRUE(test::identical(read, model.terrain));
        const ErrorReport report = assess(read, raster, tolerance);
        EXPECT_EQ(report.violations, 0U) << surface_name(kind) << " " << tolerance << " " << voids;
        EXPECT_EQ(report.uncovered, 0U);
        EXPECT_EQ(read.tolerance, tolerance);
      }
}

TEST(CompactFit, TheSameBytesFromAnyNumberOfThreads) {
  const Raster raster = hills(120, 90, true);
  for (const CompactOptions& options :
       {CompactOptions{.surface = SurfaceKind::clough_tocher, .max_error = 1},
        CompactOptions{.surface = SurfaceKind::linear, .max_error = 1}, CompactOptions{.vertices = 150},
        CompactOptions{.vertices = 150, .folds = true}, CompactOptions{.heights_only = true, .vertices = 150}}) {
    Context one, three;
    one.threads = 1;
    three.threads = 3;
    EXPECT_EQ(fit_compact(raster, options, one).bytes, fit_compact(raster, options, three).bytes);
  }
}

TEST(CompactFit, TheFitMakesUpForTheRounding) {
  struct OpenLoop : FitSource {
    using FitSource::FitSource;
    void settle() override {}
  };
  const Raster raster = hills(120, 90, false);
  std::vector<Cell> cells;
  for (int y = 0; y < 90; y += y == 84 ? 5 : 7)
    for (int x = 0; x < 120; x += x == 112 ? 7 : 8) cells.push_back(cell_at(x, y));
  CompactFrameFacts facts;
  facts.grid = {raster.columns, raster.rows, 1, 1, {}};
  facts.steps = {12, 0, 16};
  const auto rmse = [&](bool closed) {
    HeldFit fit(raster, cells, {});
    fit.solve(1e-6);
    FitSource with(fit);
    OpenLoop without(fit);
    return assess(encode_compact(facts, cells, closed ? static_cast<ValueSource&>(with) : without).terrain, raster)
        .rmse;
  };
  EXPECT_LT(rmse(true), 0.97 * rmse(false));
}

TEST(CompactFit, SlopesInTheFitMakeSlopesTruerForNoMoreBytes) {
  RETALHO_DATA_FILE(path, "dem/crater.pgm");
  const Raster raster = read_raster(path);
  const auto fit = [&](double weight) {
    const CompactModel model = fit_compact(raster, {.vertices = 2000, .slope_weight = weight, .effort = Effort::fast});
    return std::pair{model.bytes.size(), assess(model.terrain, raster)};
  };
  const auto [bytes, with] = fit(CompactOptions{}.slope_weight);
  const auto [bytes_without, without] = fit(0);
  EXPECT_LT(with.slope_rmse, 0.9 * without.slope_rmse);
  EXPECT_LT(bytes, bytes_without);
  EXPECT_LT(with.rmse, 1.05 * without.rmse);
}

TEST(CompactFit, FoldsWhereTheGroundHasSteps) {
  // A plateau over waves: its rim is a wall of one cell.
  const Raster raster = test::make_grid(120, 90, [](int x, int y) {
    const bool inside = (x - 60) * (x - 60) + 2 * (y - 45) * (y - 45) < 1600;
    return (inside ? 30.0 : 0.0) + 4 * std::sin(x / 9.0) * std::cos(y / 11.0);
  });
  const auto bytes = [&](const CompactOptions& options) { return fit_compact(raster, options).bytes; };
  const std::string folded = bytes({.max_error = 1}), smooth = bytes({.max_error = 1, .folds = false});
  EXPECT_EQ(folded[4], 2);
  EXPECT_EQ(smooth[4], 1);
  EXPECT_LT(static_cast<double>(folded.size()), 0.9 * static_cast<double>(smooth.size()));
  EXPECT_FALSE(std::get<Terrain>(decode_model(folded)).creases.empty());
}

TEST(CompactFit, RefusesWhatMakesNoSense) {
  const Raster raster = hills(20, 20, false);
  EXPECT_THROW(fit_compact(raster, {}), UsageError);
  EXPECT_THROW(fit_compact(raster, {.max_error = 1, .vertices = 10}), UsageError);
  EXPECT_THROW(fit_compact(raster, {.max_error = -1}), UsageError);
  EXPECT_THROW(fit_compact(raster, {.surface = SurfaceKind::powell_sabin, .max_error = 1}), UsageError);
  EXPECT_THROW(fit_compact(raster, {.heights_only = true, .max_error = 1}), UsageError);
  EXPECT_THROW(fit_compact(raster, {.surface = SurfaceKind::linear, .max_error = 1, .folds = true}), UsageError);
  EXPECT_THROW(fit_compact(raster, {.heights_only = true, .vertices = 50, .folds = true}), UsageError);
  EXPECT_THROW(fit_compact(raster, {.max_error = 1e-12}), BadInput);
}

TEST(CompactFit, RealTerrainKeepsItsToleranceInFewBytes) {
  RETALHO_DATA_FILE(path, "dem/crater.pgm");
  const Raster raster = read_raster(path);
  const CompactModel model = fit_compact(raster, {.max_error = 24});
  EXPECT_EQ(assess(std::get<Terrain>(decode_model(model.bytes)), raster, 24).violations, 0U);
  EXPECT_LT(model.bytes.size(), 2000U);  // LERC_ZSTD needs 13,779, the prototype's flat TIN 2,494
}

}  // namespace
}  // namespace retalho
