// From the file to curves, and from curves to files.
#include "curve_work.h"

#include <fmt/format.h>

#include <filesystem>

#include "inputs.h"
#include "needs_in_space.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/curve/bspline.h"
#include "retalho/curve/convert.h"
#include "retalho/curve/edit.h"
#include "retalho/curve/flatten.h"
#include "retalho/curve/vector_file.h"
#include "retalho/level/implicit_graph.h"

namespace retalho::app {
namespace {

std::vector<CurveSpec> read_specs(const std::string& file, const Program& program) {
  if (!std::filesystem::exists(file)) throw CannotRead(fmt::format("'{}': no such file", file), file);
  check_file_need("reading the curves of", kCurveFile, file);
  if (file.ends_with(".json")) return read_curves(file).curves;
  std::vector<CurveSpec> specs;
  if (file.ends_with(".svg")) {
    int transforms = 0;
    for (const Curve& curve : read_svg(file, &transforms)) specs.push_back(to_spec(curve));
    if (transforms > 0)
      program.say(fmt::format(
          "'{}': {} elements stand under a transform, which is not applied: the numbers are taken as they are", file,
          transforms));
    return specs;
  }
  for (const VectorLine& line : read_vector_lines(file)) {
    CurveSpec spec;
    spec.kind = CurveKind::polyline;
    spec.name = line.name;
    spec.dimension = line.dimension;
    spec.closed = line.closed;
    spec.points = line.points;
    specs.push_back(std::move(spec));
  }
  return specs;
}

[[noreturn]] void at_place(const Error& error, const std::string& where) {
  throw BadInput(fmt::format("{}: {}", where, error.what()), error.file(), where);
}

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

std::vector<Vec3> lifted(const std::vector<Vec2>& points) {
  std::vector<Vec3> out;
  out.reserve(points.size());
  for (const Vec2 p : points) out.push_back({p.x, p.y, 0});
  return out;
}

/// Lines of any form, for vector files and for the JSON of curves that have no exact one.
std::vector<VectorLine> lines_of(const NamedCurve& c, double tolerance, const Context& context) {
  std::vector<VectorLine> lines;
  if (c.curve) {
    const double t = tolerance > 0 ? tolerance : 1e-4 * std::max(control_size(c.curve->points), 1e-300);
    const FlatCurve flat = flatten(*c.curve, t, context);
    for (std::size_t k = 0; k < flat.starts.size(); ++k) {
      const std::size_t from = flat.starts[k],
                        to = k + 1 < flat.starts.size() ? flat.starts[k + 1] : flat.points.size();
      VectorLine line{c.spec.name,
                      {flat.points.begin() + static_cast<std::ptrdiff_t>(from),
                       flat.points.begin() + static_cast<std::ptrdiff_t>(to)},
                      c.curve->dimension,
                      flat.closed};
      if (line.closed) line.points.pop_back();
      lines.push_back(std::move(line));
    }
  }
  if (c.graph)
    for (const auto& points : c.graph->lines) lines.push_back({c.spec.name, lifted(points), 2, false});
  if (c.level)
    for (const ImplicitLine& line : c.level->lines) lines.push_back({c.spec.name, lifted(line.points), 2, line.closed});
  return lines;
}

CurveSpec converted(const NamedCurve& c, const std::string& kind) {
  CurveSpec spec;
  if (kind == "bezier") {
    spec = to_spec(elevate(*c.curve, c.curve->degree()));
  } else if (kind == "bspline") {
    const BSpline s = to_bspline(*c.curve);
    spec.kind = CurveKind::bspline;
    spec.degree = s.degree;
    spec.knots = s.knots;
    spec.points = s.points;
    spec.weights = s.weights;
    spec.closed = c.curve->closed;
  } else if (kind == "hermite") {
    if (c.curve->rational() || c.curve->degree() > 3)
      throw UsageError(fmt::format(
          "{}: only polynomial curves of degree 3 or less are cubic Hermite curves; use --degree 3", c.where));
    const HermiteData data = to_hermite(elevate(*c.curve, 3));
    for (std::size_t i = 0; i < data.points.size(); ++i) {
      const bool shared = i % 2 == 0 && i > 0;
      if (shared && norm(data.points[i] - data.points[i - 1]) + norm(data.tangents[i] - data.tangents[i - 1]) >
                        1e-9 * (control_size(c.curve->points) + norm(data.tangents[i])))
        throw UsageError(
            fmt::format("{}: at parameter {} the curve is not C1: it has no Hermite form with one tangent a point",
                        c.where, data.breaks[i]));
      if (shared) continue;
      spec.points.push_back(data.points[i]);
      spec.tangents.push_back(data.tangents[i]);
      spec.breaks.push_back(data.breaks[i]);
    }
    spec.kind = CurveKind::hermite;
  } else {
    if (c.curve->segment_count() != 1)
      throw UsageError(fmt::format("{}: the power basis is for one segment; this curve has {}: --cut it", c.where,
                                   c.curve->segment_count()));
    spec.kind = CurveKind::power;
    spec.points = to_power(c.curve->segment(0));
    spec.breaks = {c.curve->begin(), c.curve->end()};
  }
  spec.dimension = c.curve->dimension;
  spec.name = c.spec.name;
  return spec;
}

void write_json(const std::vector<NamedCurve>& curves, const std::string& path, const CurveWork& work, bool overwrite,
                const Context& context) {
  const bool changed = work.degree > 0 || work.reverse || !work.cut.empty();
  CurveDocument document;
  for (const NamedCurve& c : curves) {
    if (work.flatten > 0 || (!c.curve && !work.convert.empty())) {
      for (const VectorLine& line : lines_of(c, work.flatten, context)) {
        CurveSpec spec;
        spec.kind = CurveKind::polyline;
        spec.name = line.name;
        spec.dimension = line.dimension;
        spec.closed = line.closed;
        spec.points = line.points;
        document.curves.push_back(std::move(spec));
      }
    } else if (c.curve && !work.convert.empty()) {
      document.curves.push_back(converted(c, work.convert));
    } else if (c.curve && changed) {
      CurveSpec spec = to_spec(*c.curve);
      spec.name = c.spec.name;
      document.curves.push_back(std::move(spec));
    } else {
      document.curves.push_back(c.spec);
    }
  }
  write_file(path, to_json(document), overwrite);
}

void add_to_panel(PicturePanel& panel, const NamedCurve& c, const CurveWork& work, Rgb color) {
  const Stroke stroke{color, 1.8, false, false};
  if (c.graph) draw_explicit(panel, *c.graph, stroke);
  if (c.level) draw_implicit(panel, *c.level, stroke);
  if (!c.curve) return;
  const Curve plane = project(*c.curve, work.view);
  if (work.comb) draw_comb(panel, plane, work.comb_scale, {120, 120, 200});
  if (work.control) draw_control_polygon(panel, plane, {130, 130, 130});
  if (work.flatten > 0)
    draw_curve(panel, straight(flatten(plane, work.flatten), 2), stroke);
  else
    draw_curve(panel, plane, stroke);
  if (work.tangents) draw_tangents(panel, plane, 1.0 / 3, {0, 120, 60});
  if (work.casteljau) draw_casteljau(panel, plane, *work.casteljau);
  if (work.joins) draw_joins(panel, plane, color);
  if (work.points && !c.spec.points.empty()) {
    Curve given;
    given.dimension = c.spec.dimension;
    for (const Vec3& p : c.spec.points) given.append(std::array{p});
    for (const Vec3& p : project(given, work.view).points) panel.dots.push_back({{p.x, p.y}, 3.2, {0, 0, 0}, false});
  }
}

void draw(const std::vector<NamedCurve>& curves, const std::string& path, const CurveWork& work, bool overwrite) {
  CurvePicture picture;
  picture.panel_width = work.width;
  picture.panel_height = work.height;
  PicturePanel panel;
  panel.title = work.title;
  panel.axes = work.axes;
  panel.stretch = work.stretch;
  for (std::size_t i = 0; i < curves.size(); ++i) add_to_panel(panel, curves[i], work, curve_color(i));
  fit_panel(panel);
  for (const NamedCurve& c : curves) {
    if (c.spec.kind == CurveKind::implicit_form && curves.size() == 1)
      panel.low = {c.spec.box[0], c.spec.box[1]}, panel.high = {c.spec.box[2], c.spec.box[3]};
    if (c.graph && curves.size() == 1)
      panel.low.y = c.graph->low - 0.06 * (c.graph->high - c.graph->low),
      panel.high.y = c.graph->high + 0.06 * (c.graph->high - c.graph->low);
  }
  if (!work.window.empty()) {
    panel.low = {work.window[0], work.window[1]};
    panel.high = {work.window[2], work.window[3]};
    if (!(panel.low.x < panel.high.x && panel.low.y < panel.high.y))
      throw UsageError("--window: xmin < xmax and ymin < ymax are needed", {}, "--window");
  }
  picture.panels.push_back(std::move(panel));
  if (work.hodograph)
    for (std::size_t i = 0; i < curves.size(); ++i)
      if (curves[i].curve)
        picture.panels.push_back(hodograph_panel(project(*curves[i].curve, work.view), curve_color(i)));
  write_picture(picture, path, overwrite);
}

}  // namespace

std::vector<NamedCurve> load_curves(const std::string& file, const CurveWork& work, const Program& program) {
  note_input(file);
  if (!work.convert.empty()) choose("--convert", work.convert, {"bezier", "bspline", "hermite", "power"});
  if (work.flatten < 0) throw UsageError("--flatten: the tolerance must be positive", {}, "--flatten");
  const Context context = program.context();
  std::vector<NamedCurve> curves;
  for (CurveSpec& spec : read_specs(file, program)) {
    NamedCurve c;
    c.where = fmt::format("curves[{}]", curves.size());
    c.spec = std::move(spec);
    try {
      if (c.spec.kind == CurveKind::implicit_form) {
        const auto& b = c.spec.box;
        c.level = trace_implicit(Expression::parse(c.spec.f), {b[0], b[1], b[2], b[3]}, {.depth = work.depth}, context);
      } else if (c.spec.kind == CurveKind::explicit_form) {
        const Expression f = Expression::parse(c.spec.f);
        c.curve = polynomial_graph(f, c.spec.from, c.spec.to);
        if (!c.curve) c.graph = trace_explicit(f, c.spec.from, c.spec.to, {}, context);
      }
    } catch (const BadInput& error) {
      at_place(error, c.where + ".f");
    }
    try {
      if (!c.level && !c.curve && !c.graph) c.curve = to_curve(c.spec, c.where);
    } catch (const BadInput& error) {
      throw BadInput(error.what(), file, error.where());
    }
    if (c.curve) {
      if (!work.cut.empty()) c.curve = cut(*c.curve, work.cut[0], work.cut[1]);
      if (work.degree > 0) {
        Reduction reduced = reduce(elevate(*c.curve, std::min(work.degree, kMaxCurveDegree)), work.degree);
        c.curve = std::move(reduced.curve);
        c.reduction_error = reduced.error;
      }
      if (work.reverse) c.curve = reverse(*c.curve);
    }
    curves.push_back(std::move(c));
  }
  return curves;
}

void write_curves(const std::vector<NamedCurve>& curves, const std::string& path, const CurveWork& work, bool overwrite,
                  const Context& context) {
  context.check();
  if (path.ends_with(".json")) return write_json(curves, path, work, overwrite, context);
  if (path.ends_with(".svg") || path.ends_with(".pdf") || path.ends_with(".png"))
    return draw(curves, path, work, overwrite);
  std::vector<VectorLine> lines;
  for (const NamedCurve& c : curves)
    for (VectorLine& line : lines_of(c, work.flatten, context)) lines.push_back(std::move(line));
  write_vector_lines(lines, path, overwrite);
}

}  // namespace retalho::app
