// Contour lines: certified lines of smooth surfaces, beside gdal_contour and contourpy on the flat surface, same run.
//   bench_contour                    the whole table
//   bench_contour --value CASE       raw, simplified, threads, memory, levels, clough-tocher, powell-sabin, rough,
//   peers, thinning
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "retalho/level/contour.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/fit.h"
#include "retalho/tin/scattered.h"

using namespace retalho;

namespace {

constexpr int kSide = 4096;
constexpr double kStep = 5.5;

double cpu() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}
double wall() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) * 1024;
  return 0;
}
double resident_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) * 1024;
  return 0;
}

/// A fractal terrain by diamonds and squares, seed fixed; heights over about 1.5 km.
const Raster& fractal() {
  static const Raster raster = [] {
    constexpr int n = kSide + 1;
    std::vector<float> z(static_cast<std::size_t>(n) * n, 0);
    std::mt19937_64 random(20240229);
    const auto at = [&](int x, int y) -> float& {
      return z[static_cast<std::size_t>(y) * n + static_cast<std::size_t>(x)];
    };
    const auto noise = [&](double size) {
      return static_cast<float>(size * (2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1));
    };
    double size = 600;
    for (int step = kSide; step > 1; step /= 2, size *= 0.5) {
      const int half = step / 2;
      for (int y = half; y < n; y += step)
        for (int x = half; x < n; x += step)
          at(x, y) =
              (at(x - half, y - half) + at(x + half, y - half) + at(x - half, y + half) + at(x + half, y + half)) / 4 +
              noise(size);
      for (int y = 0; y < n; y += half)
        for (int x = (y / half) % 2 == 0 ? half : 0; x < n; x += step) {
          float sum = 0;
          int count = 0;
          for (const auto& [dx, dy] : {std::array{-half, 0}, {half, 0}, {0, -half}, {0, half}})
            if (x + dx >= 0 && x + dx < n && y + dy >= 0 && y + dy < n) {
              sum += at(x + dx, y + dy);
              ++count;
            }
          at(x, y) = sum / static_cast<float>(count) + noise(size);
        }
    }
    Raster r;
    r.columns = r.rows = kSide;
    std::vector<float> cut(r.cells());
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) cut[r.index(x, y)] = at(x, y);
    r.heights = std::move(cut);
    return r;
  }();
  return raster;
}

std::vector<double> levels_of(const Raster& raster, double step) {
  const RasterSummary s = summarize(raster);
  return contour_levels(s.minimum, s.maximum, step);
}

double cells() {
  return static_cast<double>(kSide) * kSide;
}

struct Run {
  double cpu_seconds = 0, wall_seconds = 0;
  std::size_t vertices = 0;
  ContourSet set;  ///< without its lines
  ContourStats stats;
};

/// Spline, fixed point, tracing and lines, as `retalho contour` has them: each line is seen once.
Run contour(const Raster& raster, double step, bool simplify, int threads, double tolerance = 0.1) {
  const double c = cpu(), w = wall();
  Run run;
  run.set = stream_contours(
      raster, {}, levels_of(raster, step), {tolerance, simplify},
      [&](const ContourSet& part) {
        for (const ContourLine& line : part.lines) run.vertices += line.end - line.begin;
      },
      {.threads = threads}, &run.stats);
  run.cpu_seconds = cpu() - c;
  run.wall_seconds = wall() - w;
  return run;
}

/// Franke's function on random points, many levels: M sub-triangles a second, one thread.
double triangulated(SurfaceKind kind) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points;
  const auto q = [](double a) { return a * a; };
  for (int i = 0; i < 100000; ++i) {
    const double x = unit(random), y = unit(random);
    points.push_back(
        {x, y,
         .75 * std::exp(-(q(9 * x - 2) + q(9 * y - 2)) / 4) + .75 * std::exp(-q(9 * x + 1) / 49 - (9 * y + 1) / 10) +
             .5 * std::exp(-(q(9 * x - 7) + q(9 * y - 3)) / 4) - .2 * std::exp(-q(9 * x - 4) - q(9 * y - 7))});
  }
  const Terrain terrain =
      make_terrain(triangulate_points(points), Georef{}, {.surface = kind, .gradients = GradientKind::quadratic});
  const std::vector<double> levels = contour_levels(0, 1.3, 1.0 / 128);
  double best = 1e300;
  for (int i = 0; i < 3; ++i) {
    const double c = cpu();
    trace_contours(terrain, levels, {.tolerance = 0.0003, .simplify = false}, {.threads = 1});
    best = std::min(best, cpu() - c);
  }
  return static_cast<double>(terrain.tin.triangle_count()) * patches_per_triangle(kind) / best / 1e6;
}

nlohmann::json peers() {
  const auto folder = std::filesystem::temp_directory_path() / "retalho-bench-contour";
  std::filesystem::create_directories(folder);
  const std::string raw = (folder / "z.f32").string();
  {
    std::ofstream out(raw, std::ios::binary);
    const auto& z = std::get<std::vector<float>>(fractal().heights);
    out.write(reinterpret_cast<const char*>(z.data()), static_cast<std::streamsize>(z.size() * sizeof(float)));
  }
  const std::vector<double> levels = levels_of(fractal(), kStep);
  const std::string command = fmt::format("/usr/bin/python3 '{}/peers/flat_contours.py' '{}' {} {} {} {}",
                                          RETALHO_BENCH_DIR, raw, kSide, levels.front(), kStep, levels.size());
  std::string text;
  if (FILE* pipe = popen(command.c_str(), "r")) {
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) text += buffer.data();
    pclose(pipe);
  }
  std::filesystem::remove_all(folder);
  return nlohmann::json::parse(text);
}

/// Vertices of Douglas and Peucker's algorithm on the raw lines at the tolerance, for all lines.
std::size_t douglas_peucker(const ContourSet& set, double tolerance) {
  std::size_t kept = 0;
  for (const ContourLine& line : set.lines) {
    std::vector<Vec2> p(set.points.begin() + static_cast<std::ptrdiff_t>(line.begin),
                        set.points.begin() + static_cast<std::ptrdiff_t>(line.end));
    if (line.closed) p.push_back(p.front());
    std::vector<std::pair<std::size_t, std::size_t>> stack{{0, p.size() - 1}};
    ++kept;
    while (!stack.empty()) {
      const auto [a, b] = stack.back();
      stack.pop_back();
      double worst = -1;
      std::size_t at = a;
      const Vec2 d = p[b] - p[a];
      for (std::size_t i = a + 1; i < b; ++i) {
        const double along = norm2(d) > 0 ? std::clamp(dot(p[i] - p[a], d) / norm2(d), 0.0, 1.0) : 0;
        const double off = norm(p[i] - p[a] - along * d);
        if (off > worst) {
          worst = off;
          at = i;
        }
      }
      if (worst > tolerance) {
        stack.emplace_back(a, at);
        stack.emplace_back(at, b);
      } else {
        ++kept;
      }
    }
  }
  return kept;
}

/// Ours over Douglas and Peucker's at the same tolerance, on a terrain whose lines are apart (one every 12 cells or
/// so).
double thinning() {
  const Raster& raster = fractal();
  constexpr double tolerance = 0.25;
  const Run ours = contour(raster, 100, true, 0, tolerance);
  const ContourSet raw = trace_contours(raster, {}, levels_of(raster, 100), {tolerance / 5, false});
  return static_cast<double>(ours.vertices) / static_cast<double>(douglas_peucker(raw, tolerance));
}

/// The demo's rough grid: M (cell, level) pairs a second with 5 m between levels.
double rough() {
  const Raster raster = read_raster(std::string(RETALHO_BENCH_DIR) + "/../examples/jacksboro.vrt");
  const double tolerance = 0.1 * std::min(raster.cell_width, raster.cell_height);
  double best = 1e300;
  std::size_t pairs = 0;
  for (int i = 0; i < 3; ++i) {
    const Run run = contour(raster, 5, false, 1, tolerance);
    best = std::min(best, run.cpu_seconds);
    pairs = run.stats.pairs;
  }
  return static_cast<double>(pairs) / best / 1e6;
}

/// Bytes a cell at the peak, the raster's own included.
double memory(double step) {
  const Raster& raster = fractal();
  std::ofstream("/proc/self/clear_refs") << "5";
  const double before = resident_bytes();
  contour(raster, step, true, 1);
  return (peak_bytes() - before) / cells() + sizeof(float);
}

double best_of(int times, const std::function<double()>& value) {
  double best = value();
  for (int i = 1; i < times; ++i) best = std::max(best, value());
  return best;
}

double measure(const std::string& what) {
  if (what == "raw") return best_of(3, [] { return cells() / contour(fractal(), kStep, false, 1).cpu_seconds / 1e6; });
  if (what == "simplified")
    return best_of(3, [] { return cells() / contour(fractal(), kStep, true, 1).cpu_seconds / 1e6; });
  if (what == "threads")
    return best_of(3, [] {
      return contour(fractal(), kStep, true, 1).wall_seconds / contour(fractal(), kStep, true, 2).wall_seconds;
    });
  if (what == "memory") return memory(kStep);
  if (what == "levels") {
    const double few = memory(4 * kStep);
    return memory(kStep) / few;
  }
  if (what == "clough-tocher") return triangulated(SurfaceKind::clough_tocher);
  if (what == "powell-sabin") return triangulated(SurfaceKind::powell_sabin);
  if (what == "rough") return rough();
  if (what == "thinning") return thinning();
  if (what == "peers") return cells() / peers().at("gdal_seconds").get<double>() / 1e6;
  fmt::print(stderr, "bench_contour: unknown value '{}'\n", what);
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "--value") {
    fmt::print("{}\n", nlohmann::json{{"value", measure(argv[2])}}.dump());
    return 0;
  }
  const nlohmann::json flat = peers();
  const Run raw = contour(fractal(), kStep, false, 1), thin = contour(fractal(), kStep, true, 1);
  fmt::print("fractal terrain {0} x {0}, a level every {1}: {2} flat segments\n", kSide, kStep,
             flat.at("segments").get<long>());
  const auto row = [&](const char* name, double seconds) {
    fmt::print("{:<44}{:>8.2f} s {:>8.2f} M cells/s\n", name, seconds, cells() / seconds / 1e6);
  };
  row("certified lines, tolerance 0.1 cell", raw.cpu_seconds);
  row("the same, thinned", thin.cpu_seconds);
  row("contourpy, flat", flat.at("contourpy_seconds").get<double>());
  row("gdal_contour, flat", flat.at("gdal_seconds").get<double>());
  fmt::print("{} pairs, {:.1f} % certified at once, depth {}, {} boxes; vertices {} raw, {} thinned; singular {}\n",
             raw.stats.pairs, 100.0 * static_cast<double>(raw.stats.certified) / static_cast<double>(raw.stats.pairs),
             raw.stats.depth, raw.stats.boxes, raw.vertices, thin.vertices, raw.set.singular.size());
  // Not memory and levels: in a process that has freed memory before, they would say too little.
  for (const char* what : {"threads", "clough-tocher", "powell-sabin", "rough", "thinning"})
    fmt::print("{:<16}{:.3f}\n", what, measure(what));
}
