#include "breaklines.h"

#include <fmt/format.h>

#include <cmath>

#include "inputs.h"
#include "retalho/cloud/breaklines.h"
#include "retalho/core/error.h"

namespace retalho::app {

void add_breakline_flags(CLI::App& command, BreaklineFlags& flags) {
  command
      .add_option("--breaklines", flags.file,
                  "Points: lines that triangles keep to and that the surface may fold along (a vector layer)")
      ->type_name("FILE");
  command.add_option("--breakline-layer", flags.layer, "Of --breaklines: which layer")->type_name("NAME");
}

void check_breakline_flags(const BreaklineFlags& flags, bool from_points) {
  if (flags.given() && !from_points)
    throw UsageError("--breaklines goes with points: a grid's cells have their places already", {}, "--breaklines");
  if (!flags.given() && !flags.layer.empty())
    throw UsageError("--breakline-layer goes with --breaklines", {}, "--breakline-layer");
}

ConstrainedTin triangulate(const Program& program, const PointCloud& cloud, const std::string& input,
                           const BreaklineFlags& flags, ScatteredNotes* notes, const Context& context) {
  if (!flags.given()) return {triangulate_points(cloud.positions, notes, context), {}};
  BreaklineFile file = read_breaklines(flags.file, flags.layer, context);
  Georef theirs;
  theirs.crs_wkt = file.crs_wkt;
  check_same_crs(cloud.georef, input, theirs, flags.file);
  std::size_t vertices = 0;
  const PointSummary summary = summarize(cloud);
  const Vec3 extent = summary.maximum - summary.minimum;
  // Steps as long as the points are apart.
  const double spacing = std::sqrt(extent.x * extent.y / static_cast<double>(summary.points));
  for (std::vector<Vec3>& line : file.lines) {
    for (Vec3& p : line) {
      const Vec2 local = cloud.georef.to_local({p.x, p.y});
      p = {local.x, local.y, p.z};
      ++vertices;
    }
    if (spacing > 0) line = with_steps(line, spacing);
  }
  BreaklineNotes lines;
  ConstrainedTin made = triangulate_points(cloud.positions, file.lines, notes, &lines, context);
  program.say(fmt::format("{}: {} breaklines with {} vertices, {} edges along them", flags.file, lines.lines, vertices,
                          made.edges.size()));
  if (file.others > 0)
    program.say(fmt::format("  {} geometries that are neither lines nor polygons are left out", file.others));
  if (lines.draped > 0)
    program.say(fmt::format("  {} vertices have no height: they lie on the flat surface of the points", lines.draped));
  if (lines.crossings > 0)
    program.say(
        fmt::format("  lines cross at {} places: a vertex with the mean height each (largest difference {:.6g})",
                    lines.crossings, lines.largest_disagreement));
  return made;
}

}  // namespace retalho::app
