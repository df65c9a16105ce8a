// Bytes of compact models (model/compact.h) against peers, on the grids of $RETALHO_DATA/dem and the demo's
// (docs/bytes.md; scripts/bytes-all makes the page).
//
//   bench_bytes --rows FILE [--most CELLS]   measures what FILE does not yet hold, the small grids first, and keeps it
//   bench_bytes --value NAME --rows FILE     one JSON line from FILE; NAME as in `values` below
//
// Equal largest error E: GDAL's GeoTIFF with COMPRESS=LERC_ZSTD, MAX_Z_ERROR=E in one strip; the plain grid by an
// interpolating pyramid (pyramid.h); the flat and the Clough-Tocher compact file. Files are read back and every cell is
// compared. Equal bytes: the flat compact file at a number of vertices, and Clough-Tocher at the same bytes, by
// log-linear interpolation between two budgets around them.
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <sys/stat.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "pyramid.h"
#include "retalho/model/compact.h"
#include "retalho/model/model.h"
#include "retalho/raster/gdal.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/report.h"
#include "support.h"

namespace {

using namespace retalho;
using nlohmann::json;
namespace fs = std::filesystem;
using bench::cpu_seconds, bench::grids;

constexpr int kParts[] = {25, 50, 100};      // of the height range: largest errors
constexpr double kPercents[] = {0.75, 3.0};  // flat vertices, of the valid cells

/// One strip, as strong as zstd gets.
std::size_t lerc_bytes(const Raster& raster, double max_error) {
  register_gdal();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  const char* options = driver->GetMetadataItem(GDAL_DMD_CREATIONOPTIONLIST);
  if (!options || std::string(options).find("LERC_ZSTD") == std::string::npos)
    throw std::runtime_error("this GDAL has no LERC_ZSTD");
  const char* path = "/vsimem/bench_bytes.tif";
  char** list = nullptr;
  list = CSLSetNameValue(list, "COMPRESS", "LERC_ZSTD");
  list = CSLSetNameValue(list, "MAX_Z_ERROR", fmt::format("{:.17g}", max_error).c_str());
  list = CSLSetNameValue(list, "ZSTD_LEVEL", "22");
  list = CSLSetNameValue(list, "BLOCKYSIZE", std::to_string(raster.rows).c_str());
  // Integers as integers, as the file they came from has them.
  bool whole = true, narrow = true;
  for (std::size_t k = 0; k < raster.cells(); ++k) {
    const double z = raster.at(k);
    if (std::isnan(z)) continue;
    whole = whole && z == std::floor(z);
    narrow = narrow && std::abs(z) < 32767;
  }
  const bool has_void = summarize(raster).valid < raster.cells();
  const GDALDataType type = whole && narrow                                              ? GDT_Int16
                            : std::holds_alternative<std::vector<float>>(raster.heights) ? GDT_Float32
                                                                                         : GDT_Float64;
  std::vector<double> z(raster.cells());
  for (std::size_t k = 0; k < z.size(); ++k)
    z[k] = std::isnan(raster.at(k)) ? (type == GDT_Int16 ? -32768 : NAN) : raster.at(k);
  GDALDataset* dataset = driver->Create(path, raster.columns, raster.rows, 1, type, list);
  CSLDestroy(list);
  if (has_void) dataset->GetRasterBand(1)->SetNoDataValue(type == GDT_Int16 ? -32768 : NAN);
  const CPLErr outcome = dataset->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, raster.columns, raster.rows, z.data(),
                                                             raster.columns, raster.rows, GDT_Float64, 0, 0);
  GDALClose(dataset);
  if (outcome != CE_None) throw std::runtime_error("GDAL cannot write LERC_ZSTD");
  VSIStatBufL status;
  if (VSIStatL(path, &status) != 0) throw std::runtime_error("GDAL wrote nothing");
  VSIUnlink(path);
  return static_cast<std::size_t>(status.st_size);
}

json compact_facts(const CompactModel& model, const Raster& raster, double tolerance) {
  const Terrain read = std::get<Terrain>(decode_model(model.bytes));
  const ErrorReport e = assess(read, raster, tolerance);
  return {
      {"bytes", model.bytes.size()}, {"vertices", read.tin.vertex_count()}, {"rmse", e.rmse}, {"slope", e.slope_rmse},
      {"max", e.max_error},          {"over", e.violations + e.uncovered}};
}

json measure_tolerance(const Raster& raster, int part) {
  const RasterSummary summary = summarize(raster);
  const double tolerance = (summary.maximum - summary.minimum) / part;
  json row{{"tolerance", tolerance}};
  row["lerc"] = lerc_bytes(raster, tolerance);
  row["pyramid"] = bench::pyramid_bytes(raster, tolerance);
  row["flat"] =
      compact_facts(fit_compact(raster, {.surface = SurfaceKind::linear, .max_error = tolerance}), raster, tolerance);
  const double start = cpu_seconds();
  row["smooth"] = compact_facts(fit_compact(raster, {.max_error = tolerance}), raster, tolerance);
  row["us_a_cell"] = 1e6 * (cpu_seconds() - start) / static_cast<double>(summary.valid);
  row["auto"] = std::min(row["flat"]["bytes"].get<std::size_t>(), row["smooth"]["bytes"].get<std::size_t>());
  return row;
}

json measure_budget(const Raster& raster, double percent) {
  const auto flat_vertices = static_cast<std::size_t>(percent / 100 * static_cast<double>(summarize(raster).valid));
  const auto fit = [&](SurfaceKind kind, std::size_t vertices) {
    return compact_facts(fit_compact(raster, {.surface = kind, .vertices = vertices}), raster, 0);
  };
  json row;
  row["flat"] = fit(SurfaceKind::linear, flat_vertices);
  const double bytes = row["flat"]["bytes"];
  json low = fit(SurfaceKind::clough_tocher, flat_vertices / 2);
  const double ratio = bytes / low["bytes"].get<double>();
  json high = fit(SurfaceKind::clough_tocher,
                  static_cast<std::size_t>(static_cast<double>(flat_vertices) / 2 * ratio * (ratio > 1 ? 1.1 : 0.9)));
  const auto at_equal_bytes = [&](const char* what) {
    const double a = std::log(low["bytes"].get<double>()), b = std::log(high["bytes"].get<double>());
    const double t = (std::log(bytes) - a) / (b - a);
    return std::exp((1 - t) * std::log(low[what].get<double>()) + t * std::log(high[what].get<double>()));
  };
  row["smooth"] = {{"low", low}, {"high", high}, {"rmse", at_equal_bytes("rmse")}, {"slope", at_equal_bytes("slope")}};
  return row;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += std::log(v);
  return std::exp(sum / static_cast<double>(values.size()));
}

bool is_urban(const std::string& name) {
  return name.starts_with("dom1");
}

/// What the targets ask for, over the rows that there are.
std::map<std::string, double> values(const json& rows) {
  std::vector<double> lerc, urban, flat, pyramid, rmse, slope, best;
  for (const auto& [name, row] : rows["tolerance"].items()) {
    if (name.ends_with(" 100")) continue;
    const double ours = row["auto"];
    (is_urban(name) ? urban : lerc).push_back(ours / row["lerc"].get<double>());
    if (!is_urban(name)) flat.push_back(row["smooth"]["bytes"].get<double>() / row["flat"]["bytes"].get<double>());
    pyramid.push_back(ours / row["pyramid"].get<double>());
  }
  for (const auto& [name, row] : rows["budget"].items()) {
    const double ratio = row["smooth"]["rmse"].get<double>() / row["flat"]["rmse"].get<double>();
    best.push_back(std::min(1.0, ratio));
    if (is_urban(name)) continue;
    rmse.push_back(ratio);
    slope.push_back(row["smooth"]["slope"].get<double>() / row["flat"]["slope"].get<double>());
  }
  std::map<std::string, double> result;
  const auto worst = [](const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); };
  if (!lerc.empty()) result["lerc"] = worst(lerc);
  if (!urban.empty()) result["lerc:urban"] = worst(urban);
  if (!flat.empty()) result["flat"] = worst(flat), result["flat:mean"] = mean(flat);
  if (!pyramid.empty()) result["pyramid"] = mean(pyramid);
  if (!rmse.empty()) result["rmse"] = worst(rmse), result["rmse:mean"] = mean(rmse), result["slope:mean"] = mean(slope);
  return result;
}

json load(const fs::path& file) {
  std::ifstream in(file);
  return in ? json::parse(in) : json::object();
}

void measure_all(const fs::path& file, std::size_t most) {
  json rows = load(file);
  struct stat build {};
  ::stat("/proc/self/exe", &build);
  if (rows.value("build", 0L) != build.st_mtime) rows = json{{"build", build.st_mtime}};
  struct Grid {
    std::string name;
    Raster raster;
  };
  std::vector<Grid> all;
  for (const fs::path& path : grids()) {
    Raster raster = read_raster(path.string());
    if (raster.cells() <= most) all.push_back({path.filename().string(), std::move(raster)});
  }
  std::sort(all.begin(), all.end(), [](const Grid& a, const Grid& b) { return a.raster.cells() < b.raster.cells(); });
  const auto keep = [&](const char* kind, const std::string& name, const auto& measure) {
    if (rows.contains(kind) && rows[kind].contains(name)) return;
    rows[kind][name] = measure();
    std::ofstream(file) << rows.dump(1) << '\n';
    std::cerr << kind << ' ' << name << '\n';
  };
  for (const Grid& grid : all) {
    for (const int part : kParts)
      keep("tolerance", fmt::format("{} {}", grid.name, part), [&] { return measure_tolerance(grid.raster, part); });
    for (const double percent : kPercents)
      keep("budget", fmt::format("{} {}", grid.name, percent), [&] { return measure_budget(grid.raster, percent); });
  }
}

}  // namespace

int main(int count, char** words) {
  try {
    std::map<std::string, std::string> options;
    for (int k = 1; k + 1 < count; k += 2) options[words[k]] = words[k + 1];
    const fs::path rows = options.count("--rows") != 0 ? options["--rows"] : "build/bytes-rows.json";
    if (options.count("--value") == 0) {
      measure_all(rows, options.count("--most") != 0 ? std::stoul(options["--most"]) : 50'000'000);
      return 0;
    }
    if (!fs::exists(rows)) measure_all(rows, 250'000);
    const auto found = values(load(rows));
    const auto value = found.find(options["--value"]);
    if (value == found.end())
      throw std::runtime_error("no rows for " + options["--value"] + " in " + rows.string() +
                               ": measure the grids that it needs (scripts/bytes-all)");
    std::cout << json{{"value", value->second}}.dump() << '\n';
  } catch (const std::exception& e) {
    std::cerr << "bench_bytes: " << e.what() << '\n';
    return 1;
  }
}
