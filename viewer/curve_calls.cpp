#include "curve_calls.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/curve/continuity.h"
#include "retalho/curve/document.h"
#include "retalho/curve/edit.h"
#include "retalho/curve/explicit.h"
#include "retalho/curve/flatten.h"
#include "retalho/curve/measure.h"
#include "retalho/level/implicit_curve.h"

namespace retalho::viewer {
namespace {

constexpr std::size_t kMostCurves = 64, kMostPoints = 4000;
constexpr int kCombTeeth = 28;  // a segment

CurveDocument document_of(const Json& input) {
  const auto at = input.find("document");
  if (at == input.end()) throw BadInput("the call lacks 'document'", {}, "document");
  CurveDocument document = parse_curves(at->dump());
  check_size(document);
  return document;
}

Json place(Vec3 p) {
  return {p.x, p.y};
}

Json places(const std::vector<Vec3>& points) {
  Json list = Json::array();
  for (const Vec3 p : points) list.push_back(place(p));
  return list;
}

/// The drawn curve: one list of points for each unbroken part. The distance of the drawing is a five-thousandth of its
/// size.
Json drawn(const Curve& curve) {
  Json lines = Json::array();
  const Bounds3 box = exact_bounds(curve);
  const double size = norm(box.high - box.low);
  const FlatCurve flat = flatten(curve, std::max(1e-300, 2e-4 * size));
  for (std::size_t k = 0; k < flat.starts.size(); ++k) {
    const std::size_t end = k + 1 < flat.starts.size() ? flat.starts[k + 1] : flat.points.size();
    Json line = Json::array();
    for (std::size_t i = flat.starts[k]; i < end; ++i) line.push_back(place(flat.points[i]));
    lines.push_back(std::move(line));
  }
  return lines;
}

std::string level_name(char sort, int level) {
  return level < 0 ? "none" : fmt::format("{}{}", sort, level);
}

Json joins_words(const Curve& curve) {
  Json list = Json::array();
  for (const Join& j : analyse_joins(curve))
    list.push_back({{"at", j.at},
                    {"point", place(j.point)},
                    {"C", level_name('C', j.c)},
                    {"G", level_name('G', j.g)},
                    {"gap", j.gap},
                    {"angle", j.angle * 180 / std::numbers::pi},
                    {"curvature_left", j.curvature_left},
                    {"curvature_right", j.curvature_right},
                    {"curvature_gap", j.curvature_gap},
                    {"speed_ratio", j.speed_ratio},
                    {"kind", join_kind_name(j.kind)}});
  return list;
}

/// Points with the normal times the curvature: [x, y, kx, ky] each, one list a segment.
Json comb(const Curve& curve) {
  Json segments = Json::array();
  for (std::size_t s = 0; s < curve.segment_count(); ++s) {
    Json teeth = Json::array();
    const double from = curve.breaks[s], to = curve.breaks[s + 1];
    for (int k = 0; k <= kCombTeeth; ++k) {
      const double u = from + (to - from) * k / kCombTeeth;
      const Side side = k == 0 ? Side::right : Side::left;
      const CurveJet jet = evaluate_jet(curve, u, side);
      const double speed = std::hypot(jet.first.x, jet.first.y);
      if (!(speed > 0)) continue;
      const double bend = curvature(curve, u, side) / speed;
      teeth.push_back({jet.point.x, jet.point.y, jet.first.y * bend, -jet.first.x * bend});
    }
    segments.push_back(std::move(teeth));
  }
  return segments;
}

Json casteljau_words(const Curve& curve, double fraction) {
  const double u = curve.begin() + fraction * (curve.end() - curve.begin());
  const auto [segment, t] = locate(curve, u);
  Json rows = Json::array();
  for (const std::vector<Vec3>& row : casteljau_rows(curve.segment(segment), t)) rows.push_back(places(row));
  const CurveJet jet = evaluate_jet(curve, u);
  return {{"u", u},
          {"segment", segment},
          {"t", t},
          {"rows", rows},
          {"point", place(jet.point)},
          {"derivative", place(jet.first)},
          {"curvature", curvature(curve, u)}};
}

void add_parametric(Json& words, const Curve& space, const Json& input) {
  const Curve curve = with_dimension(space, 2);
  const Bounds3 box = exact_bounds(curve);
  words["degree"] = curve.degree();
  words["segments"] = curve.segment_count();
  words["length"] = arc_length(space);
  words["bounds"] = {box.low.x, box.low.y, box.high.x, box.high.y};
  words["lines"] = drawn(curve);
  Json control = Json::array();
  for (std::size_t s = 0; s < curve.segment_count(); ++s) {
    const CurveSegment segment = curve.segment(s);
    control.push_back(places({segment.points.begin(), segment.points.end()}));
  }
  words["control"] = std::move(control);
  words["joins"] = joins_words(curve);
  Json turns = Json::array();
  for (const CurvePoint& p : inflections(curve)) turns.push_back(place(p.point));
  words["inflections"] = std::move(turns);
  if (flag_or(input, "comb", false)) words["comb"] = comb(curve);
  if (flag_or(input, "hodograph", false)) words["hodograph"] = drawn(hodograph(curve));
  if (input.contains("t")) words["casteljau"] = casteljau_words(curve, number(input, "t", 0, 1));
}

void add_implicit(Json& words, const CurveSpec& spec, const Context& context) {
  const auto& b = spec.box;
  const ImplicitCurve level =
      trace_implicit(Expression::parse(spec.f), {b[0], b[1], b[2], b[3]}, {.depth = 8}, context);
  Json lines = Json::array(), cells = Json::array();
  for (const ImplicitLine& line : level.lines) {
    Json points = Json::array();
    for (const Vec2 p : line.points) points.push_back({p.x, p.y});
    if (line.closed && !line.points.empty()) points.push_back({line.points[0].x, line.points[0].y});
    lines.push_back(std::move(points));
  }
  for (const PlaneBox& cell : level.unresolved) cells.push_back({cell.x0, cell.y0, cell.x1, cell.y1});
  words["lines"] = std::move(lines);
  words["cells"] = std::move(cells);
  words["bounds"] = b;
  words["certified"] = level.unresolved.empty() && level.doubtful.empty();
}

void add_graph(Json& words, const CurveSpec& spec, const Context& context) {
  const ExplicitCurve graph = trace_explicit(Expression::parse(spec.f), spec.from, spec.to, {}, context);
  Json lines = Json::array();
  for (const auto& line : graph.lines) {
    Json points = Json::array();
    for (const Vec2 p : line) points.push_back({p.x, p.y});
    lines.push_back(std::move(points));
  }
  words["lines"] = std::move(lines);
  words["bounds"] = {spec.from, graph.low, spec.to, graph.high};
  words["breaks"] = graph.breaks;
}

Answer compute_call(const Json& input, const Context& context) {
  const CurveDocument document = document_of(input);
  Json list = Json::array();
  for (std::size_t i = 0; i < document.curves.size(); ++i) {
    const CurveSpec& spec = document.curves[i];
    context.check();
    Json words = {{"kind", curve_kind_name(spec.kind)}, {"name", spec.name}, {"dimension", spec.dimension}};
    try {  // one curve that is wrong while it is drawn or typed must not hide the others
      if (spec.kind == CurveKind::implicit_form)
        add_implicit(words, spec, context);
      else if (spec.kind == CurveKind::explicit_form)
        add_graph(words, spec, context);
      else
        add_parametric(words, to_curve(spec, fmt::format("curves[{}]", i)), input);
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      words["error"] = error.what();
    }
    list.push_back(std::move(words));
  }
  return {{{"curves", list}}};
}

/// {"document", "curve", "what": "split" at "t" | "elevate" | "bezier"}: the document with that curve changed, its
/// shape not.
Answer change_call(const Json& input, const Context&) {
  CurveDocument document = document_of(input);
  const auto index =
      static_cast<std::size_t>(whole(input, "curve", 0, static_cast<std::int64_t>(document.curves.size()) - 1));
  const std::string what = word(input, "what", {"split", "elevate", "bezier"});
  CurveSpec& spec = document.curves[index];
  if (spec.kind == CurveKind::implicit_form || spec.kind == CurveKind::explicit_form)
    throw BadInput("a formula has no control points: this works on curves with a parameter");
  const Curve curve = to_curve(spec, fmt::format("curves[{}]", index));
  Curve changed = curve;
  if (what == "split") {
    const double u = curve.begin() + number(input, "t", 1e-6, 1 - 1e-6) * (curve.end() - curve.begin());
    if (std::find(curve.breaks.begin(), curve.breaks.end(), u) != curve.breaks.end())
      throw BadInput("there is a join at this parameter already");
    changed = refine(curve, std::array{u});
  } else if (what == "elevate") {
    changed = elevate(curve, curve.degree() + 1);
  }
  CurveSpec made = to_spec(changed);
  made.name = spec.name;
  spec = std::move(made);
  return {{{"document", Json::parse(to_json(document))}}};
}

}  // namespace

void check_size(const CurveDocument& document) {
  std::size_t points = 0;
  for (const CurveSpec& spec : document.curves) points += spec.points.size();
  if (document.curves.size() > kMostCurves || points > kMostPoints)
    throw BadInput(fmt::format("the page shows at most {} curves of {} points together", kMostCurves, kMostPoints));
}

void add_curve_calls(CallTable& table, const InputFiles& inputs) {
  Json files = Json::array();
  for (const CurvesInput& one : inputs.curves)
    files.push_back({{"name", one.name}, {"described", one.described}, {"document", one.document}});
  table["/api/curves/files"] = {Call::Kind::quick, [files](const Json&, const Context&) {
                                  return Answer{{{"files", files}}};
                                }};
  table["/api/curves/compute"] = {Call::Kind::quick, compute_call};
  table["/api/curves/change"] = {Call::Kind::quick, change_call};
}

}  // namespace retalho::viewer
