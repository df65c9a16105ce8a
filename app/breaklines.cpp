#include "breaklines.h"

#include <fmt/format.h>

#include <limits>

#include "inputs.h"
#include "retalho/core/error.h"
#include "retalho/curve/vector_file.h"

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

void check_breakline_budget(const BreaklineFlags& flags, bool budget) {
  if (flags.given() && budget)
    throw UsageError("--breaklines keeps every point: leave --max-error, --vertices and --ratio out", {},
                     "--breaklines");
}

namespace {

LineLayer read_lines(const Georef& ours, const std::string& input, const std::string& file, const std::string& layer,
                     const char* option, const Context& context) {
  LineLayer lines = read_line_layer(file, layer, option, context);
  Georef theirs;
  theirs.crs_wkt = lines.crs_wkt;
  check_same_crs(ours, input, theirs, file);
  return lines;
}

}  // namespace

std::vector<std::vector<Vec2>> read_crease_lines(const Georef& grid, const std::string& input, const std::string& file,
                                                 const std::string& layer, const Context& context) {
  std::vector<std::vector<Vec2>> lines;
  for (const VectorLine& line : read_lines(grid, input, file, layer, "--crease-layer", context).lines) {
    std::vector<Vec2>& places = lines.emplace_back();
    for (const Vec3& p : line.points) places.push_back(grid.to_local({p.x, p.y}));
    if (line.closed) places.push_back(places.front());
  }
  return lines;
}

ConstrainedTin triangulate(const Program& program, const PointCloud& cloud, const std::string& input,
                           const BreaklineFlags& flags, ScatteredNotes* notes, const Context& context) {
  if (!flags.given()) return {triangulate_points(cloud.positions, notes, context), {}};
  const LineLayer layer = read_lines(cloud.georef, input, flags.file, flags.layer, "--breakline-layer", context);
  const double spacing = mean_spacing(cloud.positions);  // steps as long as the points are apart
  std::size_t vertices = 0;
  std::vector<std::vector<Vec3>> breaklines;
  for (const VectorLine& line : layer.lines) {
    std::vector<Vec3> places;
    places.reserve(line.points.size() + 1);
    for (const Vec3& p : line.points) {
      const Vec2 local = cloud.georef.to_local({p.x, p.y});
      places.push_back({local.x, local.y, line.dimension == 3 ? p.z : std::numeric_limits<double>::quiet_NaN()});
    }
    vertices += places.size();
    if (line.closed) places.push_back(places.front());
    breaklines.push_back(spacing > 0 ? with_steps(places, spacing) : places);
  }
  BreaklineNotes lines;
  ConstrainedTin made = triangulate_points(cloud.positions, breaklines, notes, &lines, context);
  program.say(fmt::format("{}: {} breaklines with {} vertices, {} edges along them", flags.file, lines.lines, vertices,
                          made.edges.size()));
  if (layer.others > 0)
    program.say(fmt::format("  {} geometries that are neither lines nor polygons are left out", layer.others));
  if (lines.draped > 0)
    program.say(fmt::format("  {} vertices have no height: they lie on the flat surface of the points", lines.draped));
  if (lines.crossings > 0)
    program.say(
        fmt::format("  lines cross at {} places: a vertex with the mean height each (largest difference {:.6g})",
                    lines.crossings, lines.largest_disagreement));
  return made;
}

}  // namespace retalho::app
