#include "retalho/render/curve_sheet.h"

#include <array>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/curve/flatten.h"

namespace retalho {
namespace {

/// A polyline of straight segments from each line of a flattened curve.
Curve straight(const FlatCurve& flat, int dimension) {
  Curve out;
  out.dimension = dimension;
  out.closed = flat.closed;
  std::size_t next = 1;
  for (std::size_t i = 0; i + 1 < flat.points.size(); ++i) {
    if (next < flat.starts.size() && flat.starts[next] == i + 1) {
      ++next;
      continue;
    }
    out.append(std::array{flat.points[i], flat.points[i + 1]});
  }
  return out;
}

void add_to_panel(PicturePanel& panel, const SheetCurve& c, const CurveSheetOptions& options, Rgb color,
                  const Context& context) {
  const Stroke stroke{color, 1.8, false, false};
  if (c.graph != nullptr) draw_explicit(panel, *c.graph, stroke);
  if (c.level != nullptr) draw_implicit(panel, *c.level, stroke);
  if (c.curve == nullptr) return;
  const Curve plane = project(*c.curve, options.view);
  if (options.comb) draw_comb(panel, plane, options.comb_scale, {120, 120, 200});
  if (options.control) draw_control_polygon(panel, plane, {130, 130, 130});
  if (options.flatten > 0)
    draw_curve(panel, straight(flatten(plane, options.flatten, context), 2), stroke);
  else
    draw_curve(panel, plane, stroke);
  if (options.tangents) draw_tangents(panel, plane, 1.0 / 3, {0, 120, 60});
  if (options.casteljau) draw_casteljau(panel, plane, *options.casteljau);
  if (options.joins) draw_joins(panel, plane, color);
  if (options.points && !c.given.empty()) {
    Curve given;
    given.dimension = c.dimension;
    for (const Vec3& p : c.given) given.append(std::array{p});
    for (const Vec3& p : project(given, options.view).points) panel.dots.push_back({{p.x, p.y}, 3.2, {0, 0, 0}, false});
  }
}

}  // namespace

CurvePicture curve_sheet(const std::vector<SheetCurve>& curves, const CurveSheetOptions& options,
                         const Context& context) {
  CurvePicture picture;
  picture.panel_width = options.width;
  picture.panel_height = options.height;
  PicturePanel panel;
  panel.title = options.title;
  panel.axes = options.axes;
  panel.stretch = options.stretch;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    context.check();
    add_to_panel(panel, curves[i], options, curve_color(i), context);
  }
  fit_panel(panel);
  if (curves.size() == 1) {  // what was asked for, whatever there is to be seen in it
    const SheetCurve& c = curves[0];
    if (c.level != nullptr && c.box.size() == 4) panel.low = {c.box[0], c.box[1]}, panel.high = {c.box[2], c.box[3]};
    if (c.graph != nullptr)
      panel.low.y = c.graph->low - 0.06 * (c.graph->high - c.graph->low),
      panel.high.y = c.graph->high + 0.06 * (c.graph->high - c.graph->low);
  }
  if (!options.window.empty()) {
    panel.low = {options.window[0], options.window[1]};
    panel.high = {options.window[2], options.window[3]};
    if (!(panel.low.x < panel.high.x && panel.low.y < panel.high.y))
      throw UsageError("the window is empty: xmin < xmax and ymin < ymax are needed", {}, "window");
  }
  picture.panels.push_back(std::move(panel));
  if (options.hodograph)
    for (std::size_t i = 0; i < curves.size(); ++i)
      if (curves[i].curve != nullptr)
        picture.panels.push_back(hodograph_panel(project(*curves[i].curve, options.view), curve_color(i)));
  return picture;
}

}  // namespace retalho
