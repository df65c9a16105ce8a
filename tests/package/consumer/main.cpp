// The example of README.md: from an elevation grid to a smooth model, its error and a file.
#include <cstdio>
#include <exception>
#include <utility>
#include <variant>

#include "retalho/model/model.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/report.h"
#include "retalho/tin/refine.h"

int main(int argc, char** argv) {
  try {
    if (argc != 3) return std::fprintf(stderr, "usage: consumer DEM MODEL\n"), 2;
    const retalho::Raster raster = retalho::read_raster(argv[1]);
    retalho::Tin tin = retalho::refine_tin(raster, {.max_error = 20});
    const retalho::Terrain terrain =
        retalho::make_terrain(std::move(tin), raster, {.surface = retalho::SurfaceKind::clough_tocher});
    const retalho::ErrorReport report = retalho::assess(terrain, raster);
    std::printf("%zu vertices, RMSE %.3f\n", terrain.tin.points.size(), report.rmse);
    const retalho::TerrainEvaluator evaluator(terrain);
    const retalho::Vec2 centre = raster.centre(raster.columns / 2, raster.rows / 2);
    std::printf("height at the centre %.1f, in the grid %.1f\n", evaluator.value(centre),
                raster.at(raster.columns / 2, raster.rows / 2));
    retalho::save_model(terrain, argv[2], true);
    const auto again = std::get<retalho::Terrain>(retalho::load_model(argv[2]));
    return again.tin.points.size() == terrain.tin.points.size() && evaluator.value(centre) > 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
