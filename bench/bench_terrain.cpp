// Speed of the terrain evaluator: rasters, bulk points, random single queries; beside scipy's
// CloughTocher2DInterpolator on the same triangulation, measured in the same run (Debian's python3-scipy).
//
//   bench_terrain                 a table
//   bench_terrain --value NAME    one JSON line, for example raster-clough-tocher-10000 (ns a point),
//                                 single-powell-sabin-10000 (ns a query), peer-ratio-10000 (scipy's time / ours)
#include <fmt/format.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>

#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"

namespace {

using namespace retalho;

constexpr int kSide = 2000;  // 4 M points

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Work>
double best_of(int runs, const Work& work) {
  double best = 1e300;
  for (int k = 0; k < runs; ++k) {
    const double start = cpu_seconds();
    work();
    best = std::min(best, cpu_seconds() - start);
  }
  return best;
}

struct Peer {
  Tin tin;
  double ns_per_point = 0, rmse = 0;
};

template <class T>
std::vector<T> read_all(const std::filesystem::path& path) {
  std::vector<T> data(std::filesystem::file_size(path) / sizeof(T));
  std::ifstream(path, std::ios::binary)
      .read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(data.size() * sizeof(T)));
  return data;
}

/// Runs scipy once and takes its triangulation over.
Peer run_peer(int points) {
  std::string folder = (std::filesystem::temp_directory_path() / "bench_terrain_XXXXXX").string();
  if (!mkdtemp(folder.data())) throw std::runtime_error("no temporary folder");
  const std::string command = fmt::format("/usr/bin/python3 {}/peers/scipy_clough_tocher.py {} {} {}",
                                          RETALHO_BENCH_DIR, points, kSide, folder);
  FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  for (char buffer[4096]; pipe && fgets(buffer, sizeof buffer, pipe);) text += buffer;
  if (!pipe || pclose(pipe) != 0)
    throw std::runtime_error("the peer failed (Debian's python3-scipy is needed): " + command);
  const auto json = nlohmann::json::parse(text);
  Peer peer;
  peer.ns_per_point = json.at("ns_per_point");
  peer.rmse = json.at("rmse");
  const auto xyz = read_all<double>(std::filesystem::path(folder) / "points.bin");
  const auto corners = read_all<std::uint32_t>(std::filesystem::path(folder) / "triangles.bin");
  for (std::size_t k = 0; k < xyz.size(); k += 3) {
    peer.tin.points.push_back({xyz[k], xyz[k + 1]});
    peer.tin.heights.push_back(xyz[k + 2]);
  }
  for (std::size_t k = 0; k < corners.size(); k += 3)
    peer.tin.triangles.push_back({corners[k], corners[k + 1], corners[k + 2]});
  build_neighbors(peer.tin);
  std::filesystem::remove_all(folder);
  return peer;
}

struct Kind {
  const char* name;
  SurfaceOptions options;
};

std::vector<Kind> kinds() {
  return {{"linear", {.surface = SurfaceKind::linear}},
          {"powell-sabin", {.surface = SurfaceKind::powell_sabin, .gradients = GradientKind::quadratic}},
          {"clough-tocher", {.surface = SurfaceKind::clough_tocher, .gradients = GradientKind::quadratic}},
          {"clough-tocher-cubic",
           {.surface = SurfaceKind::clough_tocher,
            .gradients = GradientKind::quadratic,
            .cross_derivative = CrossDerivative::cubic}}};
}

using Results = std::map<std::string, double>;

void measure(int points, Results& results) {
  const Peer peer = run_peer(points);
  Context one;
  one.threads = 1;
  std::vector<double> z(static_cast<std::size_t>(kSide) * kSide);
  const double cells = static_cast<double>(z.size()), step = 1.0 / kSide;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec2> scattered(1000000);
  for (Vec2& p : scattered) p = {unit(random), unit(random)};
  std::vector<Vec2> lattice;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) lattice.push_back({(c + 0.5) * step, 1 - (r + 0.5) * step});
  for (const Kind& kind : kinds()) {
    const Terrain terrain = make_terrain(peer.tin, Georef{}, kind.options, one);
    std::optional<TerrainEvaluator> evaluator;
    const double build = best_of(3, [&] { evaluator.emplace(terrain, one); });
    const double raster = best_of(5, [&] {
      evaluator->grid_values({step / 2, 1 - step / 2}, {step, step}, kSide, kSide, z, {}, one);
    });
    const double bulk = best_of(3, [&] { evaluator->values(lattice, z, one); });
    double sum = 0;
    const double single = best_of(3, [&] {
      for (const Vec2 p : scattered) sum += evaluator->value(p);
    });
    const std::string key = fmt::format("{}-{}", kind.name, points);
    results["raster-" + key] = raster / cells * 1e9;
    results["bulk-" + key] = bulk / cells * 1e9;
    results["single-" + key] = single / static_cast<double>(scattered.size()) * 1e9;
    std::fprintf(stderr,
                 "%6d points  %-20s raster %6.2f ns a point, values() %6.2f, single random query %6.1f, building %5.1f "
                 "ms (%g)\n",
                 points, kind.name, results["raster-" + key], results["bulk-" + key], results["single-" + key],
                 build * 1e3, sum);
  }
  results[fmt::format("peer-{}", points)] = peer.ns_per_point;
  results[fmt::format("peer-ratio-{}", points)] =
      peer.ns_per_point / results[fmt::format("raster-clough-tocher-{}", points)];
  std::fprintf(stderr, "%6d points  scipy CloughTocher2DInterpolator %.1f ns a point: %.1f times ours\n", points,
               peer.ns_per_point, results[fmt::format("peer-ratio-{}", points)]);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wanted = argc == 3 && std::string(argv[1]) == "--value" ? argv[2] : "";
  Results results;
  for (const int points : {10000, 100000}) {
    if (!wanted.empty() && !wanted.ends_with(fmt::format("-{}", points))) continue;
    measure(points, results);
  }
  if (wanted.empty()) return 0;
  if (!results.count(wanted)) {
    std::fprintf(stderr, "no such value: %s\n", wanted.c_str());
    return 2;
  }
  std::cout << nlohmann::json{{"value", results[wanted]}} << "\n";
}
