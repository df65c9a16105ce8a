// From heights to vertices and triangles, beside the plain worst-first refinement in the same run. The figures of hmm
// (the fastest peer, not packaged for Debian) are those measured on a machine of this kind; see docs/algorithms.
//   bench_tin                      the whole table
//   bench_tin --value CASE:WHAT    CASE: n44_15, n44_2, n48_1, gabilan, budget; WHAT: time, vertices, memory, speedup
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "retalho/raster/io.h"
#include "retalho/tin/greedy_heap.h"
#include "retalho/tin/refine.h"
#include "support.h"

using namespace retalho;

namespace {

struct Case {
  const char* name;
  const char* file;
  double tolerance;
  bool lower_half;                                     // the lower half of the rows, voids filled with 0
  double peer_vertices, peer_seconds, peer_megabytes;  // hmm's; 0: not known
};

constexpr Case kCases[] = {
    {"n44_15", "N44W072.hgt", 15, false, 70634, 0.26, 24},
    {"n44_2", "N44W072.hgt", 2, false, 632878, 1.9, 105},
    {"n48_1", "N48W125.hgt.zip", 1, true, 1097846, 4.2, 217},
    {"gabilan", "gabilan.bil", 0.5, false, 4425 / 1.0206, 0, 0},
};

double cpu() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

double peak_megabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
  return 0;
}
void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}
double resident_megabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024;
  return 0;
}

Raster load(const Case& c) {
  Raster r = read_raster(bench::dem(c.file));
  if (!c.lower_half) return r;
  const auto& z = std::get<std::vector<float>>(r.heights);
  Raster half = r;
  half.rows = 1801;
  std::vector<float> part(z.end() - static_cast<std::ptrdiff_t>(half.cells()), z.end());
  for (float& h : part)
    if (std::isnan(h)) h = 0;
  half.heights = std::move(part);
  return half;
}

struct Measured {
  double seconds = 1e300, wall = 1e300, megabytes = 0;
  std::size_t vertices = 0;
};
template <class Work>
Measured measure(const Work& work, int runs) {
  Measured m;
  for (int i = 0; i < runs; ++i) {
    forget_peak();
    const double start = cpu(), before = resident_megabytes();
    const auto clock = std::chrono::steady_clock::now();
    const GridTin tin = work();
    m.wall = std::min(m.wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count());
    m.seconds = std::min(m.seconds, cpu() - start);
    m.megabytes = std::max(m.megabytes, peak_megabytes() - before);
    m.vertices = tin.cells.size();
  }
  return m;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wanted = argc > 2 && std::string(argv[1]) == "--value" ? argv[2] : "";
  const auto value = [](double v) { fmt::print("{{\"value\": {:.6g}}}\n", v); };
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  try {
    for (const Case& c : kCases) {
      const std::string prefix = std::string(c.name) + ":";
      if (!wanted.empty() && !wanted.starts_with(prefix) &&
          !(wanted.starts_with("budget:") && std::string(c.name) == "n44_15"))
        continue;
      const Raster r = load(c);
      if (wanted.starts_with("budget:")) {
        const auto budget = static_cast<std::size_t>(c.peer_vertices);
        const Measured m = measure([&] { return refine_grid(r, {.vertices = budget}, one); }, 3);
        value(m.seconds / c.peer_seconds);
        return 0;
      }
      const RefineOptions options{.max_error = c.tolerance};
      const Measured ours = measure([&] { return refine_grid(r, options, one); }, 3);
      // The raster itself, 4 bytes a cell as in the peer's figure, counts too.
      const double megabytes = ours.megabytes + 4e-6 * static_cast<double>(r.cells());
      if (wanted == prefix + "time") return value(c.peer_seconds > 0 ? ours.seconds / c.peer_seconds : ours.seconds), 0;
      if (wanted == prefix + "vertices") return value(static_cast<double>(ours.vertices) / c.peer_vertices), 0;
      if (wanted == prefix + "memory") return value(megabytes / c.peer_megabytes), 0;
      const Measured doubled = measure([&] { return refine_grid(r, options, two); }, 3);
      if (wanted == prefix + "speedup") return value(ours.wall / doubled.wall), 0;
      const Measured plain = measure([&] { return refine_grid_by_heap(r, options, one); }, 1);
      fmt::print(
          "{} at {} m: {} vertices (plain {}, ratio {:.4f}; hmm {:.0f}, {:.4f}), {:.3f} s CPU (plain {:.3f}, ratio "
          "{:.2f}; hmm {:.2f}, {:.2f}), "
          "{:.0f} MB with the grid (hmm {:.0f}), two threads {:.2f} times faster (wall)\n",
          c.file, c.tolerance, ours.vertices, plain.vertices,
          static_cast<double>(ours.vertices) / static_cast<double>(plain.vertices), c.peer_vertices,
          static_cast<double>(ours.vertices) / c.peer_vertices, ours.seconds, plain.seconds,
          ours.seconds / plain.seconds, c.peer_seconds, c.peer_seconds > 0 ? ours.seconds / c.peer_seconds : 0.0,
          megabytes, c.peer_megabytes, ours.wall / doubled.wall);
      std::fflush(stdout);
    }
  } catch (const Error& e) {
    fmt::print(stderr, "bench_tin: {}\n", e.what());
    return e.exit_code();
  }
}
