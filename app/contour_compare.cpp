#include "contour_compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fitting.h"
#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/raster/part.h"
#include "retalho/render/contour_path.h"
#include "retalho/render/curve_picture.h"
#include "retalho/render/field.h"
#include "retalho/tin/refine.h"

namespace retalho::app {
namespace {

struct Named {
  std::string name;
  ContourSet lines;
};

std::vector<std::string> draw(const Program& program, const std::vector<Named>& all, const Extent& shown,
                              const SurfaceComparison& comparison) {
  CurvePicture picture;
  const int panels = static_cast<int>(all.size());
  picture.columns = panels <= 3 ? panels : (panels + 1) / 2;
  const double aspect = std::clamp(shown.width() / shown.height(), 0.2, 5.0);
  picture.panel_width = static_cast<int>(std::lround(420 * std::sqrt(aspect)));
  picture.panel_height = static_cast<int>(std::lround(420 / std::sqrt(aspect))) + 16;
  std::vector<std::string> names;
  for (const Named& one : all) {
    PicturePanel panel;
    panel.caption = one.name;
    panel.low = shown.low;
    panel.high = shown.high;
    PicturePath frame;
    frame.path = {{PathVerb::move, PathVerb::line, PathVerb::line, PathVerb::line, PathVerb::close},
                  {shown.low, {shown.high.x, shown.low.y}, shown.high, {shown.low.x, shown.high.y}}};
    frame.stroke = {{150, 150, 150}, 1};
    frame.decoration = true;
    panel.paths.push_back(frame);
    for (const ContourLine& line : one.lines.lines) {
      PicturePath path;
      path.path = contour_path(one.lines, line);
      path.stroke = {{120, 70, 30}, comparison.index[static_cast<std::size_t>(line.level)] ? 1.8 : 0.8};
      panel.paths.push_back(std::move(path));
    }
    picture.panels.push_back(std::move(panel));
    names.push_back(one.name);
  }
  write_picture(picture, comparison.output, program.overwrite);
  return names;
}

}  // namespace

Raster middle_of(const Raster& raster, int zoom) {
  if (zoom <= 0 || (zoom >= raster.columns && zoom >= raster.rows)) return raster;
  const int columns = std::min(zoom, raster.columns), rows = std::min(zoom, raster.rows);
  return part_of(raster, {(raster.columns - columns) / 2, (raster.rows - rows) / 2, columns, rows});
}

std::vector<std::string> compare_grid_surfaces(const Program& program, const Raster& raster,
                                               const SurfaceComparison& comparison, const Context& context) {
  constexpr std::size_t kMost = 1'000'000;
  if (raster.cells() > kMost)
    throw UsageError(fmt::format("--compare-surfaces takes every cell, a million at most, not {}: show fewer (--zoom)",
                                 raster.cells()),
                     {}, "--zoom");
  const ContourOptions options{comparison.tolerance, true};
  std::vector<Named> all;
  for (const char* kind : {"linear", "powell-sabin", "clough-tocher"}) {
    SurfaceFlags flags;
    flags.surface = kind;
    const Terrain terrain = make_terrain(refine_tin(raster, {}, context), raster, resolve(flags, false), context);
    all.push_back({kind, trace_contours(terrain, comparison.levels, options, context)});
  }
  const auto bicubic = [&](const std::string& name, const BicubicOptions& how) {
    all.push_back({name, trace_contours(make_bicubic(raster, how, context), comparison.levels, options, context)});
  };
  for (const Twist twist : {Twist::spline, Twist::adini, Twist::zero})
    bicubic(fmt::format("bicubic, twist {}", twist_name(twist)), {.twist = twist});
  bicubic("bicubic, natural ends", {.ends = TangentEnds::natural});
  bicubic("bicubic, ringing", {.keep_flats = false});
  return draw(program, all, extent_of(raster), comparison);
}

std::vector<std::string> compare_point_surfaces(const Program& program, const ConstrainedTin& tin, const Georef& georef,
                                                const SurfaceComparison& comparison, const Context& context) {
  const ContourOptions options{comparison.tolerance, true};
  std::vector<Named> all;
  Extent shown;
  const auto add = [&](const std::string& kind, const std::string& gradients) {
    SurfaceFlags flags;
    flags.surface = kind;
    flags.gradients = gradients;
    SurfaceOptions how = resolve(flags, true);
    how.creases = tin.edges;
    const Terrain terrain = make_terrain(tin.tin, georef, how, context);
    shown = extent_of(terrain);
    all.push_back({gradients.empty() ? kind : fmt::format("{}, {}", kind, gradients),
                   trace_contours(terrain, comparison.levels, options, context)});
  };
  add("linear", "");
  for (const char* kind : {"powell-sabin", "clough-tocher"})
    for (const char* gradients : {"quadratic", "normals"}) add(kind, gradients);
  return draw(program, all, shown, comparison);
}

}  // namespace retalho::app
