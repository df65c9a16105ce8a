#include "retalho/render/curve_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "retalho/curve/continuity.h"
#include "retalho/curve/edit.h"
#include "retalho/curve/measure.h"

namespace retalho {

namespace {

constexpr Rgb kGrey{150, 150, 150};

Vec2 flat(Vec3 p) {
  return {p.x, p.y};
}

PlanePath polyline(const std::vector<Vec2>& points, bool closed = false) {
  PlanePath path;
  for (const Vec2 p : points) {
    path.verbs.push_back(path.verbs.empty() ? PathVerb::move : PathVerb::line);
    path.points.push_back(p);
  }
  if (closed && !points.empty()) path.verbs.push_back(PathVerb::close);
  return path;
}

void add_line(PicturePanel& panel, std::vector<Vec2> points, Rgb color, double width, bool dashed = false) {
  panel.paths.push_back({polyline(points), {color, width, dashed, false}, true});
}

/// A line with a head; the head's size goes with the line's.
void add_arrow(PicturePanel& panel, Vec2 from, Vec2 to, Rgb color) {
  const Vec2 d = to - from;
  if (norm(d) == 0) return;
  const Vec2 back = -0.14 * d, across = 0.06 * Vec2{-d.y, d.x};
  add_line(panel, {from, to}, color, 1.3);
  panel.paths.push_back({polyline({to, to + back + across, to + back - across}, true), {color, 1, false, true}, true});
}

}  // namespace

Curve project(const Curve& curve, CurveView view) {
  if (curve.dimension == 2) return curve;
  // Seen from the south-west and above: azimuth 35 degrees, elevation 25 degrees.
  constexpr double ca = 0.8191520442889918, sa = 0.5735764363510461, ce = 0.9063077870366499, se = 0.42261826174069944;
  Affine m{};
  switch (view) {
    case CurveView::iso:
      m = {{{ca, -sa, 0, 0}, {sa * se, ca * se, ce, 0}, {0, 0, 0, 0}}};
      break;
    case CurveView::top:
      m = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 0}}};
      break;
    case CurveView::front:
      m = {{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 0}}};
      break;
    case CurveView::side:
      m = {{{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 0}}};
      break;
  }
  return with_dimension(transform(curve, m), 2);
}

Rgb curve_color(std::size_t n) {
  static constexpr Rgb kColors[] = {{0, 114, 178},   {213, 94, 0},   {0, 158, 115},
                                    {204, 121, 167}, {86, 180, 233}, {230, 159, 0}};
  return kColors[n % std::size(kColors)];
}

void draw_curve(PicturePanel& panel, const Curve& plane, const Stroke& stroke) {
  // Only what SVG cannot say exactly is flattened, to a ten-thousandth of the curve's size (not of its control
  // polygon's, which may be far larger at high degrees).
  const Bounds3 box = exact_bounds(plane);
  panel.paths.push_back({to_path(plane, std::max(1e-300, 1e-4 * norm(box.high - box.low))), stroke, false});
}

void draw_control_polygon(PicturePanel& panel, const Curve& plane, Rgb color) {
  for (std::size_t i = 0; i < plane.segment_count(); ++i) {
    const CurveSegment s = plane.segment(i);
    std::vector<Vec2> points;
    for (const Vec3& p : s.points) points.push_back(flat(p));
    for (std::size_t k = 0; k < points.size(); ++k)
      panel.dots.push_back({points[k], 2.6, color, k != 0 && k + 1 != points.size()});
    add_line(panel, std::move(points), color, 0.8, true);
  }
}

void draw_tangents(PicturePanel& panel, const Curve& plane, double scale, Rgb color) {
  for (std::size_t i = 0; i < plane.segment_count(); ++i)
    for (const double u : {plane.breaks[i], plane.breaks[i + 1]}) {
      const CurveJet jet = evaluate_jet(plane, u, u == plane.breaks[i] ? Side::right : Side::left);
      add_arrow(panel, flat(jet.point), flat(jet.point + scale * jet.first), color);
    }
}

void draw_comb(PicturePanel& panel, const Curve& plane, double scale, Rgb color) {
  constexpr int kTeeth = 32;
  struct Tooth {
    Vec2 at, normal;
    double curvature;
  };
  std::vector<std::vector<Tooth>> combs(plane.segment_count());
  std::vector<double> magnitudes;
  for (std::size_t i = 0; i < plane.segment_count(); ++i) {
    const CurveSegment s = plane.segment(i);
    for (int k = 0; k <= kTeeth; ++k) {
      const CurveJet jet = evaluate_jet(s, static_cast<double>(k) / kTeeth);
      const double speed = norm(jet.first);
      if (!(speed > 1e-9 * control_size(s.points))) continue;  // no normal at a cusp
      const double curvature = cross(jet.first, jet.second).z / (speed * speed * speed);
      combs[i].push_back({flat(jet.point), Vec2{jet.first.y, -jet.first.x} / speed, curvature});
      magnitudes.push_back(std::abs(curvature));
    }
  }
  if (magnitudes.empty()) return;
  const double size = control_size(plane.points);
  if (scale <= 0) {
    // The 95th percentile, so that one sharp bend does not make the rest invisible.
    std::sort(magnitudes.begin(), magnitudes.end());
    const double typical = magnitudes[magnitudes.size() * 95 / 100];
    scale = typical > 0 ? 0.2 * size / typical : 0;
  }
  for (const auto& comb : combs) {
    std::vector<Vec2> tips;
    for (const Tooth& t : comb) {
      const double length = std::clamp(scale * t.curvature, -0.6 * size, 0.6 * size);
      tips.push_back(t.at + length * t.normal);
      add_line(panel, {t.at, tips.back()}, color, 0.6);
    }
    if (tips.size() > 1) add_line(panel, tips, color, 1.2);
  }
}

void draw_casteljau(PicturePanel& panel, const Curve& plane, double u) {
  const auto [i, t] = locate(plane, u);
  const auto rows = casteljau_rows(plane.segment(i), t);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Rgb color = curve_color(r + 1);
    std::vector<Vec2> points;
    for (const Vec3& p : rows[r]) points.push_back(flat(p));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const bool last = r + 1 == rows.size();
      panel.dots.push_back({points[k], last ? 5.0 : 3.0, last ? Rgb{200, 0, 0} : color, false});
      if (!last)
        panel.labels.push_back({points[k], r > 0 ? fmt::format("b{}^{}", k, r) : fmt::format("b{}", k), color});
    }
    if (points.size() > 1) add_line(panel, std::move(points), color, 1.2, r == 0);
  }
}

void draw_joins(PicturePanel& panel, const Curve& plane, Rgb color) {
  if (plane.empty()) return;
  panel.dots.push_back({flat(plane.points.front()), 2.6, color, false});
  panel.dots.push_back({flat(plane.points.back()), 2.6, color, false});
  for (const Join& join : analyse_joins(plane))
    panel.dots.push_back({flat(join.point), 3.4, color, join.kind != JoinKind::regular || join.g < 0});
}

void draw_explicit(PicturePanel& panel, const ExplicitCurve& curve, const Stroke& stroke) {
  for (const auto& line : curve.lines) {
    // What is far outside of the window is cut off: the picture is clipped, and huge numbers make bad files.
    const double reach = 2 * (curve.high - curve.low);
    std::vector<Vec2> points;
    points.reserve(line.size());
    for (const Vec2 p : line) points.push_back({p.x, std::clamp(p.y, curve.low - reach, curve.high + reach)});
    panel.paths.push_back({polyline(points), stroke, false});
  }
}

void draw_implicit(PicturePanel& panel, const ImplicitCurve& curve, const Stroke& stroke) {
  for (const PlaneBox& b : curve.doubtful) panel.boxes.push_back({{b.x0, b.y0}, {b.x1, b.y1}, {225, 225, 225}});
  for (const PlaneBox& b : curve.unresolved) panel.boxes.push_back({{b.x0, b.y0}, {b.x1, b.y1}, {200, 0, 0}});
  for (const ImplicitLine& line : curve.lines)
    panel.paths.push_back({polyline(line.points, line.closed), stroke, false});
}

PicturePanel hodograph_panel(const Curve& plane, Rgb color) {
  PicturePanel panel;
  panel.title = "hodograph Q'";
  draw_curve(panel, hodograph(plane), {color, 1.6, false, false});
  panel.dots.push_back({{0, 0}, 3.5, {0, 0, 0}, false});
  panel.labels.push_back({{0, 0}, "0", kGrey});
  for (std::size_t i = 0; i < plane.segment_count(); ++i)
    for (const Side side : {Side::right, Side::left}) {
      const CurveJet jet = evaluate_jet(plane, plane.breaks[i + (side == Side::left ? 1 : 0)], side);
      panel.dots.push_back({flat(jet.first), 2.6, color, false});
    }
  fit_panel(panel);
  panel.axes = true;
  return panel;
}

}  // namespace retalho
