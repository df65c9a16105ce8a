// In how many cells gdal_viewshed and we differ, and who is right: the slow twin, a sight line of its own, decides.
//   bench_viewshed_peer                      the table of docs/viewshed.md, in Markdown
//   bench_viewshed_peer --value ours|gdal    cells in which we (gdal, in % of the cells) are not as the twin says
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "gdal_viewshed.h"
#include "retalho/raster/io.h"
#include "retalho/visibility/line_of_sight.h"
#include "retalho/visibility/viewshed.h"
#include "support.h"

using namespace retalho;
namespace fs = std::filesystem;

namespace {

constexpr int kObservers = 20;
constexpr int kSide = 1000;  // larger grids are cut to their middle: the twin takes a while

Raster middle_of(const Raster& r) {
  Raster out;
  out.columns = std::min(kSide, r.columns);
  out.rows = std::min(kSide, r.rows);
  out.cell_width = r.cell_width;
  out.cell_height = r.cell_height;
  const int left = (r.columns - out.columns) / 2, top = (r.rows - out.rows) / 2;
  std::vector<float> z(out.cells());
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.columns; ++x) z[out.index(x, y)] = static_cast<float>(r.at(left + x, top + y));
  out.heights = std::move(z);  // local coordinates only: metres, so that gdal sees what we see
  return out;
}

/// What gdal_viewshed says is visible; its own program, file to file. Throws Error when it cannot be run.
std::vector<bool> gdal_viewshed(const Raster& r, const Observer& o, const std::string& folder) {
  if (!bench::run_gdal_viewshed(r, o, folder))
    throw Error(Error::Kind::internal, "gdal_viewshed cannot be run: install gdal-bin");
  const Raster seen = read_raster(folder + "/out.tif");
  if (seen.columns != r.columns || seen.rows != r.rows)
    throw Error(Error::Kind::internal, "gdal_viewshed gave another grid");
  std::vector<bool> result(r.cells());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = seen.at(i) > 0;
  return result;
}

struct Count {
  std::size_t cells = 0, differ = 0, ours_wrong = 0, gdal_misses = 0, gdal_invents = 0, checked = 0;
};

/// The twin looks at every cell in which the two differ, and at every hundredth of the others.
Count compare(const std::string& name, const std::string& folder) {
  const Raster r = middle_of(read_raster(bench::dem(name)));
  write_raster(r, folder + "/in.tif", {.creation_options = {"COMPRESS=NONE"}, .overwrite = true});
  std::mt19937_64 random(7);
  Count count;
  for (int n = 0; n < kObservers;) {
    const Observer o{static_cast<int>(random() % static_cast<unsigned>(r.columns)),
                     static_cast<int>(random() % static_cast<unsigned>(r.rows)), 2};
    if (!r.valid(o.column, o.row)) continue;
    ++n;
    const std::vector<std::uint8_t> ours = viewshed(r, o);
    const std::vector<bool> gdal = gdal_viewshed(r, o, folder);
    for (int y = 0; y < r.rows; ++y)
      for (int x = 0; x < r.columns; ++x) {
        if (!r.valid(x, y)) continue;
        const std::size_t i = r.index(x, y);
        const bool a = ours[i] != 0, b = gdal[i];
        ++count.cells;
        if (a == b && random() % 100 != 0) continue;
        const bool truth = line_of_sight(r, o, x, y).visible;
        ++count.checked;
        count.differ += a != b ? 1U : 0U;
        count.ours_wrong += a != truth ? 1U : 0U;
        if (b != truth) ++(truth ? count.gdal_misses : count.gdal_invents);
      }
  }
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wanted = argc > 2 && std::string(argv[1]) == "--value" ? argv[2] : "";
  const std::string folder = (fs::temp_directory_path() / fmt::format("retalho-viewshed-{}", ::getpid())).string();
  fs::create_directories(folder);
  int code = 0;
  try {
    std::size_t ours = 0;
    double worst = 0;
    if (wanted.empty())
      fmt::print(
          "| grid | cells looked at | differ | twin asked | ours wrong | gdal misses | gdal invents | gdal wrong |\n"
          "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    for (const char* name :
         {"crater.pgm", "dom1_32_356_5699_1_nw_2020.tif", "N44W072.hgt", "exploradores_aster.tif", "drumlin_dem.tif"}) {
      const Count c = compare(name, folder);
      const double wrong = 100 * static_cast<double>(c.gdal_misses + c.gdal_invents) / static_cast<double>(c.cells);
      if (wanted.empty())
        fmt::print("| {} | {} | {} | {} | {} | {} | {} | {:.3f} % |\n", name, c.cells, c.differ, c.checked,
                   c.ours_wrong, c.gdal_misses, c.gdal_invents, wrong);
      ours += c.ours_wrong;
      worst = std::max(worst, wrong);
    }
    if (!wanted.empty()) fmt::print("{{\"value\": {}}}\n", wanted == "gdal" ? worst : static_cast<double>(ours));
  } catch (const Error& e) {
    fmt::print(stderr, "bench_viewshed_peer: {}\n", e.what());
    code = e.exit_code();
  }
  fs::remove_all(folder);
  return code;
}
