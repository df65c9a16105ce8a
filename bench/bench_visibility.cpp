// Viewsheds and intervisibility maps, beside gdal_viewshed in the same run.
//   bench_visibility            the whole table
//   bench_visibility --value viewshed_3600 | map_1000 | map_1000_rmse | map_1000_max | map_speedup | gdal_ratio
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>

#include "gdal_viewshed.h"
#include "retalho/raster/io.h"
#include "retalho/visibility/intervisibility.h"
#include "retalho/visibility/viewshed.h"
#include "support.h"

using namespace retalho;

namespace {

double cpu_of(int who) {
  rusage u{};
  getrusage(who, &u);
  return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

double cpu_seconds(const std::function<void()>& work, int runs) {
  double best = 1e300;
  for (int i = 0; i < runs; ++i) {
    const double start = cpu_of(RUSAGE_SELF);
    work();
    best = std::min(best, cpu_of(RUSAGE_SELF) - start);
  }
  return best;
}

double wall_seconds(const std::function<void()>& work, int runs) {
  double best = 1e300;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

/// A grid enlarged `times` times by bilinear interpolation, with exactly columns x rows cells.
Raster enlarge(const Raster& r, double times, int columns, int rows) {
  Raster out;
  out.columns = columns;
  out.rows = rows;
  std::vector<float> z(out.cells());
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double fx = std::min(x / times, r.columns - 1.001), fy = std::min(y / times, r.rows - 1.001);
      const int cx = static_cast<int>(fx), cy = static_cast<int>(fy);
      const double u = fx - cx, v = fy - cy;
      z[out.index(x, y)] = static_cast<float>((1 - v) * ((1 - u) * r.at(cx, cy) + u * r.at(cx + 1, cy)) +
                                              v * ((1 - u) * r.at(cx, cy + 1) + u * r.at(cx + 1, cy + 1)));
    }
  out.heights = std::move(z);
  return out;
}

/// CPU seconds of gdal_viewshed on a file made from the raster; NaN when the program is not there.
double gdal_seconds(const Raster& r, const Observer& o, int runs) {
  const std::string folder =
      std::filesystem::temp_directory_path().string() + fmt::format("/retalho-bench-{}", ::getpid());
  std::filesystem::create_directories(folder);
  write_raster(r, folder + "/in.tif", {.creation_options = {"COMPRESS=NONE"}, .overwrite = true});
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const double start = cpu_of(RUSAGE_CHILDREN);
    if (!bench::run_gdal_viewshed(r, o, folder)) best = std::numeric_limits<double>::quiet_NaN();
    best = std::min(best, cpu_of(RUSAGE_CHILDREN) - start);
  }
  std::filesystem::remove_all(folder);
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wanted = argc > 2 && std::string(argv[1]) == "--value" ? argv[2] : "";
  const auto want = [&](const char* name) { return wanted.empty() || wanted == name; };
  const auto value = [&](double v) {
    if (!wanted.empty()) fmt::print("{{\"value\": {:.6g}}}\n", v);
  };
  Context one;
  one.threads = 1;
  try {
    const Raster n44 = read_raster(bench::dem("N44W072.hgt"));
    if (want("viewshed_3600") || want("gdal_ratio")) {
      const Raster big = enlarge(n44, 3, 3600, 3600);
      const Observer o{1800, 1800, 2};
      const double ours = cpu_seconds([&] { (void)viewshed(big, o, {}, one); }, 5);
      const double gdal = gdal_seconds(big, o, 3);
      if (wanted.empty())
        fmt::print(
            "viewshed, 3600 x 3600 cells: {:.3f} s CPU; gdal_viewshed (whole process, file to file) {:.3f} s; ratio "
            "{:.2f}\n",
            ours, gdal, ours / gdal);
      value(wanted == "gdal_ratio" ? ours / gdal : ours);
    }
    const bool map = want("map_1000") || want("map_speedup") || want("map_1000_rmse") || want("map_1000_max");
    if (map) {
      const Raster dom = read_raster(bench::dem("dom1_32_356_5699_1_nw_2020.tif"));
      std::vector<float> result;
      if (want("map_speedup")) {
        Context two;
        two.threads = 2;
        const double a = wall_seconds([&] { (void)intervisibility_map(dom, {}, one); }, 2),
                     b = wall_seconds([&] { (void)intervisibility_map(dom, {}, two); }, 2);
        if (wanted.empty())
          fmt::print("intervisibility map, 1000 x 1000 cells, two threads: {:.2f} times faster (wall)\n", a / b);
        value(a / b);
      }
      if (!want("map_1000") && !want("map_1000_rmse") && !want("map_1000_max")) return 0;
      const double seconds =
          cpu_seconds([&] { result = intervisibility_map(dom, {}, one); }, wanted == "map_1000" ? 3 : 1);
      if (wanted.empty()) fmt::print("intervisibility map, 1000 x 1000 cells, 180 directions: {:.2f} s CPU\n", seconds);
      if (wanted == "map_1000") value(seconds);
      if (want("map_1000_rmse") || want("map_1000_max")) {
        const auto exact = exact_intervisibility(dom, 25, {}, {});
        double sum = 0, worst = 0;
        std::size_t n = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
          if (std::isnan(exact[i])) continue;
          const double e = 100 * std::abs(static_cast<double>(result[i]) - static_cast<double>(exact[i])) /
                           static_cast<double>(dom.cells());
          sum += e * e;
          worst = std::max(worst, e);
          ++n;
        }
        const double rmse = std::sqrt(sum / static_cast<double>(n));
        if (wanted.empty())
          fmt::print("  against exact counts of {} observers: RMSE {:.3f} %, maximum {:.3f} % of the cells\n", n, rmse,
                     worst);
        value(wanted == "map_1000_max" ? worst : rmse);
      }
    }
  } catch (const Error& e) {
    fmt::print(stderr, "bench_visibility: {}\n", e.what());
    return e.exit_code();
  }
}
