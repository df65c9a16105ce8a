// Commands that read a tiled model by its tiles: their memory depends on the tiles' size, not on their number.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "cli/program.h"
#include "retalho/raster/io.h"

namespace retalho::test {
namespace {

constexpr int kTile = 96;

/// Bumpy ground, so that tiles have many vertices and no contour goes far.
void put_ground(const std::string& path, int cells) {
  Raster raster;
  raster.columns = raster.rows = cells;
  raster.cell_width = raster.cell_height = 5;
  std::vector<float> heights(raster.cells());
  Random random;
  for (int r = 0; r < cells; ++r)
    for (int c = 0; c < cells; ++c)
      heights[raster.index(c, r)] =
          static_cast<float>(50 * std::sin(c / 9.0) * std::cos(r / 7.0) + random.uniform(0, 2));
  raster.heights = std::move(heights);
  write_raster(raster, path);
}

/// The most memory that a run of the program had, MB; the run must succeed.
double peak_megabytes(const ScratchFolder& folder, const std::string& arguments) {
  const std::string command =
      fmt::format("cd '{}' && exec '{}' {} >/dev/null 2>&1", folder.path().string(), program_path(), arguments);
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  int status = -1;
  rusage use{};
  EXPECT_EQ(wait4(child, &status, 0, &use), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << arguments;
  return static_cast<double>(use.ru_maxrss) / 1024;
}

TEST(TileMemory, DoesNotGrowWithTheNumberOfTiles) {
  const ScratchFolder folder;
  for (const auto& [name, tiles] : {std::pair{"few", 2}, {"many", 8}}) {
    put_ground(folder / (std::string(name) + ".tif"), tiles * kTile + 1);
    ASSERT_EQ(run(folder, fmt::format("fit {0}.tif -o {0} --tiles {1} --max-error 1 -q", name, kTile)).code, 0);
  }
  for (const char* command : {"contour {0} -o {0}.gpkg --interval 50 --threads 1 --tile-memory 1",
                              "mesh {0} -o {0}.ply --tolerance 1 --threads 1 --tile-memory 1",
                              "render {0} -o {0}.png --size 400x400 --threads 1 --tile-memory 1",
                              "viewshed {0} -o {0}v.tif --observer 300,-300 --radius 200 --tile-memory 1",
                              "viewshed {0} -o {0}x.tif --exact --observer 300,-300 --radius 200"}) {
    const double few = peak_megabytes(folder, fmt::format(fmt::runtime(command), "few")),
                 many = peak_megabytes(folder, fmt::format(fmt::runtime(command), "many"));
    EXPECT_LT(many, 1.3 * few) << command << ": " << few << " MB for 4 tiles, " << many << " for 64";
    RecordProperty(command, fmt::format("{:.0f} MB, {:.0f} MB", few, many));
  }
  // What joining takes: the test would see it.
  const double joined = peak_megabytes(folder, "contour many -o b.svg --interval 50 --bands --threads 1"),
               streamed = peak_megabytes(folder, "contour many -o s.gpkg --interval 50 --threads 1 --tile-memory 1");
  EXPECT_GT(joined, 1.5 * streamed) << joined << " MB joined, " << streamed << " MB streamed";
  // Bands hold lines alone.
  const double bands = peak_megabytes(folder,
                                      "contour many -o b.gpkg --interval 50 --bands --threads 1 "
                                      "--tile-memory 1");
  EXPECT_LT(bands, 1.5 * streamed) << bands << " MB with bands, " << streamed << " MB lines alone";
}

}  // namespace
}  // namespace retalho::test
