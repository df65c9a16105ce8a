#include "retalho/render/surface_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/raster/part.h"
#include "retalho/render/contour_path.h"
#include "retalho/render/field.h"
#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"

namespace retalho {
namespace {

struct Named {
  std::string name;
  ContourSet lines;
};

ComparedSurfaces draw(const std::vector<Named>& all, const Extent& shown, const SurfaceComparison& comparison) {
  ComparedSurfaces drawn;
  CurvePicture& picture = drawn.picture;
  const int panels = static_cast<int>(all.size());
  picture.columns = panels <= 3 ? panels : (panels + 1) / 2;
  const double aspect = std::clamp(shown.width() / shown.height(), 0.2, 5.0);
  picture.panel_width = static_cast<int>(std::lround(420 * std::sqrt(aspect)));
  picture.panel_height = static_cast<int>(std::lround(420 / std::sqrt(aspect))) + 16;
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
    drawn.names.push_back(one.name);
  }
  return drawn;
}

}  // namespace

Raster middle_of(const Raster& raster, int zoom) {
  if (zoom <= 0 || (zoom >= raster.columns && zoom >= raster.rows)) return raster;
  const int columns = std::min(zoom, raster.columns), rows = std::min(zoom, raster.rows);
  return part_of(raster, {(raster.columns - columns) / 2, (raster.rows - rows) / 2, columns, rows});
}

ComparedSurfaces compare_grid_surfaces(const Raster& raster, const SurfaceComparison& comparison,
                                       const Context& context) {
  constexpr std::size_t kMost = 1'000'000;
  if (raster.cells() > kMost)
    throw UsageError(fmt::format("surfaces are compared on every cell, a million at most, not {}: show fewer (--zoom)",
                                 raster.cells()),
                     {}, "--zoom");
  const ContourOptions options{comparison.tolerance, true};
  std::vector<Named> all;
  for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
    const Terrain terrain = make_terrain(refine_tin(raster, {}, context), raster, {.surface = kind}, context);
    all.push_back({surface_name(kind), trace_contours(terrain, comparison.levels, options, context)});
  }
  const auto bicubic = [&](const std::string& name, const BicubicOptions& how) {
    all.push_back({name, trace_contours(make_bicubic(raster, how, context), comparison.levels, options, context)});
  };
  for (const Twist twist : {Twist::spline, Twist::adini, Twist::zero})
    bicubic(fmt::format("bicubic, twist {}", twist_name(twist)), {.twist = twist});
  bicubic("bicubic, natural ends", {.ends = TangentEnds::natural});
  bicubic("bicubic, ringing", {.keep_flats = false});
  return draw(all, extent_of(raster), comparison);
}

ComparedSurfaces compare_point_surfaces(const ConstrainedTin& tin, const Georef& georef,
                                        const SurfaceComparison& comparison, const Context& context) {
  const ContourOptions options{comparison.tolerance, true};
  std::vector<Named> all;
  Extent shown;
  const auto add = [&](SurfaceKind kind, GradientKind gradients) {
    const Terrain terrain =
        make_terrain(tin.tin, georef, {.surface = kind, .gradients = gradients, .creases = tin.edges}, context);
    shown = extent_of(terrain);
    std::string name = surface_name(kind);
    if (kind != SurfaceKind::linear) name += fmt::format(", {}", gradient_name(gradients));
    all.push_back({std::move(name), trace_contours(terrain, comparison.levels, options, context)});
  };
  add(SurfaceKind::linear, GradientKind::quadratic);
  for (const SurfaceKind kind : {SurfaceKind::powell_sabin, SurfaceKind::clough_tocher})
    for (const GradientKind gradients : {GradientKind::quadratic, GradientKind::normals}) add(kind, gradients);
  return draw(all, shown, comparison);
}

}  // namespace retalho
