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
#include "retalho/curve/curve_files.h"
#include "retalho/curve/edit.h"
#include "retalho/level/implicit_graph.h"

namespace retalho::app {
namespace {

std::vector<CurveSpec> read_specs(const std::string& file, const Program& program) {
  if (!std::filesystem::exists(file)) throw CannotRead(fmt::format("'{}': no such file", file), file);
  check_file_need("reading the curves of", kCurveFile, file);
  int transforms = 0;
  std::vector<CurveSpec> specs = read_curve_specs(file, &transforms);
  if (transforms > 0)
    program.say(fmt::format(
        "'{}': {} elements stand under a transform, which is not applied: the numbers are taken as they are", file,
        transforms));
  return specs;
}

[[noreturn]] void at_place(const Error& error, const std::string& where) {
  throw BadInput(fmt::format("{}: {}", where, error.what()), error.file(), where);
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
  if (c.curve) lines = vector_lines(*c.curve, c.spec.name, tolerance, context);
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
        document.curves.push_back(to_spec(line));
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

void draw(const std::vector<NamedCurve>& curves, const std::string& path, const CurveWork& work, bool overwrite,
          const Context& context) {
  std::vector<SheetCurve> drawn;
  drawn.reserve(curves.size());
  for (const NamedCurve& c : curves)
    drawn.push_back({c.curve ? &*c.curve : nullptr, c.graph ? &*c.graph : nullptr, c.level ? &*c.level : nullptr,
                     c.spec.points, c.spec.dimension, c.spec.box});
  write_picture(curve_sheet(drawn, work, context), path, overwrite);
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
    return draw(curves, path, work, overwrite, context);
  std::vector<VectorLine> lines;
  for (const NamedCurve& c : curves)
    for (VectorLine& line : lines_of(c, work.flatten, context)) lines.push_back(std::move(line));
  write_vector_lines(lines, path, overwrite);
}

}  // namespace retalho::app
