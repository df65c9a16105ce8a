// Smooth surfaces against the flat greedy triangulation, on every grid of $RETALHO_DATA/dem and the demo's, at 1, 3 and
// 6 % of the cells (docs/smooth.md; scripts/fit-all makes the page).
//
//   bench_fit --rows FILE [--most CELLS]   measures what FILE does not yet hold, the small grids first, and keeps it
//   there;
//                                          rows that another build of this program measured are dropped
//   bench_fit --value NAME [--rows FILE]   one JSON line; NAME as in `value`, `steps` and `cost` below
//
// Equal numbers: the flat surface stores 3 numbers a vertex, a smooth one 5, so it gets 0.6 of the vertices. Times are
// CPU times with one thread, but for the row that compares two threads with one.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "retalho/raster/io.h"
#include "retalho/raster/part.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/report.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/tin/refine.h"
#include "support.h"

namespace {

using namespace retalho;
using nlohmann::json;
namespace fs = std::filesystem;
using bench::cpu_seconds, bench::data_folder, bench::grids;

constexpr int kPercents[] = {1, 3, 6};

double peak_bytes() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

json facts(const ErrorReport& e, const Terrain& t) {
  return {{"vertices", t.tin.vertex_count()}, {"rmse", e.rmse},          {"max", e.max_error}, {"slope", e.slope_rmse},
          {"violations", e.violations},       {"uncovered", e.uncovered}};
}

const Context& one_thread() {
  static const Context context = [] {
    Context c;
    c.threads = 1;
    return c;
  }();
  return context;
}

/// The flat surface, the fits on its triangulation, and the refined surface at equal numbers.
json measure_equal(const Raster& raster, int percent) {
  const double cells = static_cast<double>(summarize(raster).valid);
  const auto vertices = static_cast<std::size_t>(std::llround(percent / 100.0 * cells));
  const Context& context = one_thread();
  const Tin tin = refine_tin(raster, {.vertices = vertices}, context);
  json row;
  const auto add = [&](const char* name, const Terrain& terrain) {
    row[name] = facts(assess(terrain, raster, 0, context), terrain);
  };
  const Terrain flat = make_terrain(tin, raster, {.surface = SurfaceKind::linear}, context);
  const Terrain smooth = make_terrain(tin, raster, {.surface = SurfaceKind::clough_tocher}, context);
  add("flat", flat);
  add("paper", smooth);
  add("flat_fit", fit_least_squares(flat, raster, {}, context));
  add("z_only", refine_surface(raster, {.vertices = flat.tin.vertex_count(), .heights_only = true}, context));
  add("fit", fit_least_squares(smooth, raster, {}, context));
  const double start = cpu_seconds();
  const std::size_t equal = 3 * flat.tin.vertex_count() / 5;
  add("refined", refine_surface(raster, {.vertices = equal}, context));
  row["us_a_cell"] = 1e6 * (cpu_seconds() - start) / cells;
  return row;
}

/// The same largest error: the flat surface's own at this share of the cells.
json measure_tolerance(const Raster& raster, int percent) {
  const double cells = static_cast<double>(summarize(raster).valid);
  const auto vertices = static_cast<std::size_t>(std::llround(percent / 100.0 * cells));
  const Context& context = one_thread();
  const auto flat_of = [&](const RefineOptions& options) {
    return make_terrain(refine_tin(raster, options, context), raster, {.surface = SurfaceKind::linear}, context);
  };
  const double tolerance = assess(flat_of({.vertices = vertices}), raster, 0, context).max_error;
  json row{{"tolerance", tolerance}};
  const Terrain flat = flat_of({.max_error = tolerance});
  row["flat"] = facts(assess(flat, raster, tolerance, context), flat);
  const double start = cpu_seconds();
  const Terrain ours = refine_surface(raster, {.max_error = tolerance}, context);
  row["us_a_cell"] = 1e6 * (cpu_seconds() - start) / cells;
  row["refined"] = facts(assess(ours, raster, tolerance, context), ours);
  row["numbers"] = static_cast<double>(number_count(ours)) / static_cast<double>(number_count(flat));
  return row;
}

class Rows {
 public:
  explicit Rows(fs::path file) : file_(std::move(file)) {
    struct stat self;
    if (stat("/proc/self/exe", &self) == 0) stamp_ = fmt::format("{}.{}", self.st_mtim.tv_sec, self.st_mtim.tv_nsec);
    std::ifstream in(file_);
    if (in) rows_ = json::parse(in, nullptr, false);
    if (!rows_.is_object() || rows_.value("program", "") != stamp_) rows_ = {{"program", stamp_}};
  }

  /// Measures what is missing, the cheapest grids first.
  void complete(double most_cells) {
    std::vector<std::pair<std::size_t, fs::path>> order;
    for (const fs::path& path : grids()) order.emplace_back(read_raster(path).cells(), path);
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [cells, path] : order) {
      if (static_cast<double>(cells) > most_cells) continue;
      const Raster raster = read_raster(path);
      for (const int percent : kPercents) {
        const std::string name = fmt::format("{} {}", path.filename().string(), percent);
        take("equal", name, [&] { return measure_equal(raster, percent); });
        take("tolerance", name, [&] { return measure_tolerance(raster, percent); });
      }
    }
  }

  double value(const std::string& name) const {
    std::vector<double> all;
    const auto each = [&](const char* kind, const std::function<double(const json&)>& use) {
      for (const auto& row : rows_.at(kind)) all.push_back(use(row));
    };
    const auto ratio = [](const char* what, const char* of) {
      return [=](const json& r) { return r.at(of).at(what).get<double>() / r.at("flat").at(what).get<double>(); };
    };
    const bool mean = name.ends_with(":mean");
    if (name.starts_with("equal:rmse")) each("equal", ratio("rmse", "refined"));
    if (name.starts_with("equal:slope")) each("equal", ratio("slope", "refined"));
    if (name.starts_with("z-only:rmse")) each("equal", ratio("rmse", "z_only"));
    if (name.starts_with("tolerance:numbers"))
      each("tolerance", [](const json& r) { return r.at("numbers").get<double>(); });
    if (name.starts_with("tolerance:violations"))
      each("tolerance", [](const json& r) {
        return r.at("refined").at("violations").get<double>() + r.at("refined").at("uncovered").get<double>();
      });
    if (name.starts_with("cost:refine")) each("equal", [](const json& r) { return r.at("us_a_cell").get<double>(); });
    if (all.empty()) throw std::runtime_error("no such value: " + name);
    if (!mean) return *std::max_element(all.begin(), all.end());
    double logs = 0;
    for (const double v : all) logs += std::log(v);
    return std::exp(logs / static_cast<double>(all.size()));
  }

 private:
  void take(const char* kind, const std::string& name, const std::function<json()>& measure) {
    if (rows_[kind].contains(name)) return;
    rows_[kind][name] = measure();
    std::cerr << kind << " " << name << " " << rows_[kind][name].dump() << std::endl;
    const fs::path part = file_.string() + ".part";
    std::ofstream(part) << rows_.dump(1) << "\n";
    fs::rename(part, file_);
  }

  fs::path file_;
  std::string stamp_;
  json rows_;
};

/// Surfaces where the ground has steps: a part of dom1 (1 m, urban) and crater, at 3 % of the cells; the worse of both.
double steps(const std::string& name) {
  double worst = 0;
  for (const char* file : {"dom1_32_356_5699_1_nw_2020.tif", "crater.pgm"}) {
    Raster raster = read_raster(data_folder() / "dem" / file);
    if (raster.columns == 1000) raster = part_of(raster, {300, 300, 400, 400});
    if (name == "steps:tolerance") {
      worst = std::max(worst, measure_tolerance(raster, 3).at("numbers").get<double>());
      continue;
    }
    const auto vertices = static_cast<std::size_t>(0.03 * static_cast<double>(summarize(raster).valid));
    SurfaceRefineOptions options{.vertices = 3 * vertices / 5};
    const auto rmse = [&](const Terrain& t) { return assess(t, raster, 0, one_thread()).rmse; };
    const double smooth = name == "steps:smooth" ? rmse(refine_surface(raster, options, one_thread())) : 0;
    options.creases = true;
    const Terrain creased = refine_surface(raster, options, one_thread());
    if (number_count(creased) > 5 * options.vertices) throw std::runtime_error("more numbers than the budget has");
    const double base = smooth > 0 ? smooth
                                   : rmse(make_terrain(refine_tin(raster, {.vertices = vertices}, one_thread()), raster,
                                                       {.surface = SurfaceKind::linear}, one_thread()));
    std::cerr << file << ": " << creased.creases.size() << " creases, RMSE " << rmse(creased) << " over " << base
              << "\n";
    worst = std::max(worst, rmse(creased) / base);
  }
  return worst;
}

/// Costs that need a run of their own, on bigtujunga (0.77 M cells) at 3 %.
double cost(const std::string& name) {
  const Raster raster = read_raster(data_folder() / "dem" / "bigtujunga.tif");
  const double cells = static_cast<double>(summarize(raster).valid);
  const auto vertices = static_cast<std::size_t>(0.03 * cells);
  const auto cpu = [&](const auto& work) {
    const double start = cpu_seconds();
    work();
    return 1e6 * (cpu_seconds() - start) / cells;
  };
  const auto wall = [&](const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  if (name == "cost:fixed") {
    const Terrain start = make_terrain(refine_tin(raster, {.vertices = vertices}), raster, {});
    return cpu([&] { fit_least_squares(start, raster, {}, one_thread()); });
  }
  const SurfaceRefineOptions grown{.vertices = vertices, .relocations = 0, .exchanges = 0};
  if (name == "cost:grow") return cpu([&] { refine_surface(raster, grown, one_thread()); });
  if (name == "cost:relocate") return cpu([&] { refine_surface(raster, {.vertices = vertices}, one_thread()); });
  if (name == "cost:threads") {
    Context two;
    two.threads = 2;
    const SurfaceRefineOptions options{.vertices = vertices, .relocations = 2, .exchanges = 0};
    double best_one = 1e300, best_two = 1e300;
    for (int k = 0; k < 2; ++k) {
      best_one = std::min(best_one, wall([&] { refine_surface(raster, options, one_thread()); }));
      best_two = std::min(best_two, wall([&] { refine_surface(raster, options, two); }));
    }
    return best_one / best_two;
  }
  if (name == "cost:memory") {  // over 32 bytes a cell and 2 kB a vertex, beside the grid itself
    const double before = peak_bytes();
    refine_surface(raster, {.vertices = vertices, .relocations = 1, .exchanges = 1}, one_thread());
    return (peak_bytes() - before) / (32 * cells + 2000 * static_cast<double>(vertices));
  }
  throw std::runtime_error("no such value: " + name);
}

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::string> flags{{"--rows", std::string(RETALHO_BENCH_DIR) + "/../build/fit-rows.json"},
                                           {"--most", "1e18"}};
  for (int k = 1; k + 1 < argc; k += 2) flags[argv[k]] = argv[k + 1];
  try {
    const auto wanted = flags.find("--value");
    if (wanted != flags.end() && wanted->second.starts_with("cost:") && wanted->second != "cost:refine:worst") {
      std::cout << json{{"value", cost(wanted->second)}} << "\n";
      return 0;
    }
    if (wanted != flags.end() && wanted->second.starts_with("steps:")) {
      std::cout << json{{"value", steps(wanted->second)}} << "\n";
      return 0;
    }
    Rows rows(flags["--rows"]);
    rows.complete(std::stod(flags["--most"]));
    if (wanted != flags.end()) std::cout << json{{"value", rows.value(wanted->second)}} << "\n";
  } catch (const std::exception& error) {
    std::cerr << "bench_fit: " << error.what() << "\n";
    return 1;
  }
}
