// What `retalho curve` says about curves: JSON, and the same as text.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "curve_work.h"
#include "retalho/curve/continuity.h"
#include "retalho/curve/intersect.h"
#include "retalho/curve/measure.h"

namespace retalho::app {
namespace {

using Json = nlohmann::ordered_json;

Json point_json(Vec3 p, int dimension) {
  return dimension == 3 ? Json{p.x, p.y, p.z} : Json{p.x, p.y};
}

/// "C1": as the sheet speaks; a gap is "none".
std::string level_name(char sort, int level) {
  return level < 0 ? "none" : fmt::format("{}{}", sort, level);
}

Json joins_json(const Curve& curve) {
  Json list = Json::array();
  for (const Join& j : analyse_joins(curve))
    list.push_back(
        {{"at", j.at},
         {"point", point_json(j.point, curve.dimension)},
         {"inside", j.left == j.right && curve.segment_count() > 1 ? true : j.left == j.right && !curve.closed},
         {"C", level_name('C', j.c)},
         {"G", level_name('G', j.g)},
         {"gap", j.gap},
         {"angle", j.angle * 180 / std::numbers::pi},
         {"angle_unit", "degree"},
         {"curvature_left", j.curvature_left},
         {"curvature_right", j.curvature_right},
         {"curvature_gap", j.curvature_gap},
         {"speed_ratio", j.speed_ratio},
         {"kind", join_kind_name(j.kind)}});
  return list;
}

Json points_json(const std::vector<CurvePoint>& points, int dimension, const char* value) {
  Json list = Json::array();
  for (const CurvePoint& p : points)
    list.push_back({{"at", p.at}, {"point", point_json(p.point, dimension)}, {value, p.value}});
  return list;
}

Json crossings_json(const std::vector<Crossing>& crossings, int dimension) {
  Json list = Json::array();
  for (const Crossing& c : crossings) {
    Json one = {{"at", {c.first, c.second}}, {"point", point_json(c.point, dimension)}};
    if (c.overlap) one["overlap"] = true;
    list.push_back(std::move(one));
  }
  return list;
}

Json curve_json(const Curve& curve, const CurveWork& work) {
  const int d = curve.dimension;
  const Bounds3 box = exact_bounds(curve);
  Json v = {{"degree", curve.degree()},
            {"segments", curve.segment_count()},
            {"dimension", d},
            {"rational", curve.rational()},
            {"closed", curve.closed},
            {"parameters", {curve.begin(), curve.end()}},
            {"length", arc_length(curve)}};
  v["bounds"] = d == 3 ? Json{box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z}
                       : Json{box.low.x, box.low.y, box.high.x, box.high.y};
  if (d == 2 && curve.closed) v["area"] = signed_area(curve);
  v["joins"] = joins_json(curve);
  if (d == 2) v["inflections"] = points_json(inflections(curve), d, "curvature");
  v["curvature_extrema"] = points_json(curvature_extrema(curve), d, "curvature");
  if (work.crossings) v["self_intersections"] = crossings_json(self_intersections(curve), d);
  if (!work.closest.empty())
    v["closest"] = points_json(
        closest_points(curve, {work.closest[0], work.closest[1], work.closest.size() > 2 ? work.closest[2] : 0}), d,
        "distance");
  if (!work.at.empty()) {
    Json list = Json::array();
    for (const double u : work.at) {
      const CurveJet jet = evaluate_jet(curve, u);
      list.push_back({{"at", u},
                      {"point", point_json(jet.point, d)},
                      {"first", point_json(jet.first, d)},
                      {"second", point_json(jet.second, d)},
                      {"curvature", curvature(curve, u)}});
    }
    v["values"] = std::move(list);
  }
  return v;
}

void line(std::string& out, const std::string& text) {
  out += text + "\n";
}

std::string numbers(const Json& list) {
  std::string out;
  for (const auto& v : list) out += fmt::format("{}{:.10g}", out.empty() ? "" : ", ", v.get<double>());
  return out;
}

}  // namespace

Json report_curves(const std::vector<NamedCurve>& curves, const CurveWork& work, const Context& context) {
  Json list = Json::array();
  for (const NamedCurve& c : curves) {
    context.check();
    Json v = {{"kind", curve_kind_name(c.spec.kind)}};
    if (!c.spec.name.empty()) v["name"] = c.spec.name;
    if (c.curve) v.update(curve_json(*c.curve, work));
    if (c.reduction_error >= 0) v["degree_error"] = c.reduction_error;
    if (c.graph) {
      std::size_t vertices = 0;
      for (const auto& l : c.graph->lines) vertices += l.size();
      v["lines"] = c.graph->lines.size();
      v["vertices"] = vertices;
      v["breaks"] = c.graph->breaks;
      v["evaluations"] = c.graph->evaluations;
    }
    if (c.level) {
      std::size_t closed = 0, vertices = 0;
      for (const ImplicitLine& l : c.level->lines) closed += l.closed, vertices += l.points.size();
      v["polynomial"] = c.level->polynomial;
      v["lines"] = c.level->lines.size();
      v["closed_lines"] = closed;
      v["vertices"] = vertices;
      v["unresolved_cells"] = c.level->unresolved.size();
      v["doubtful_cells"] = c.level->doubtful.size();
      v["kept_cells"] = c.level->kept;
      v["visited_cells"] = c.level->visited;
      v["grid_cells"] = c.level->grid_cells;
    }
    list.push_back(std::move(v));
  }
  Json result = {{"curves", std::move(list)}};
  if (work.crossings) {
    Json all = Json::array();
    for (std::size_t i = 0; i < curves.size(); ++i)
      for (std::size_t j = i + 1; j < curves.size(); ++j)
        if (curves[i].curve && curves[j].curve)
          for (Json& one :
               crossings_json(intersections(*curves[i].curve, *curves[j].curve), curves[i].curve->dimension)) {
            one["curves"] = {i, j};
            all.push_back(std::move(one));
          }
    result["intersections"] = std::move(all);
  }
  return result;
}

std::string report_text(const Json& report) {
  std::string out;
  std::size_t index = 0;
  for (const Json& c : report["curves"]) {
    line(out,
         fmt::format("curves[{}]{}: {}", index++, c.contains("name") ? " \"" + c["name"].get<std::string>() + "\"" : "",
                     c["kind"].get<std::string>()));
    if (c.contains("degree")) {
      line(out, fmt::format("  degree {}, segments {}{}{}, parameters {}", c["degree"].get<int>(),
                            c["segments"].get<std::size_t>(), c["rational"].get<bool>() ? ", rational" : "",
                            c["closed"].get<bool>() ? ", closed" : "", numbers(c["parameters"])));
      line(out, fmt::format("  length {:.10g}, bounds {}{}", c["length"].get<double>(), numbers(c["bounds"]),
                            c.contains("area") ? fmt::format(", area {:.10g}", c["area"].get<double>()) : ""));
      if (c.contains("degree_error"))
        line(out, fmt::format("  error of the degree reduction at most {:.3g}", c["degree_error"].get<double>()));
      for (const Json& j : c["joins"])
        line(out, fmt::format("  {} at {:.10g}: {} {} {}  gap {:.3g}  angle {:.6g} deg  curvature {:.6g} | {:.6g}",
                              j["inside"].get<bool>() ? "point" : "join", j["at"].get<double>(),
                              j["C"].get<std::string>(), j["G"].get<std::string>(), j["kind"].get<std::string>(),
                              j["gap"].get<double>(), j["angle"].get<double>(), j["curvature_left"].get<double>(),
                              j["curvature_right"].get<double>()));
      for (const char* key : {"inflections", "curvature_extrema"})
        if (c.contains(key))
          for (const Json& p : c[key])
            line(out, fmt::format("  {} at {:.10g}: point {}, curvature {:.6g}",
                                  std::string(key) == "inflections" ? "inflection" : "curvature extremum",
                                  p["at"].get<double>(), numbers(p["point"]), p["curvature"].get<double>()));
      if (c.contains("self_intersections"))
        for (const Json& p : c["self_intersections"])
          line(out, fmt::format("  crosses itself at {}: point {}", numbers(p["at"]), numbers(p["point"])));
      if (c.contains("closest"))
        for (const Json& p : c["closest"])
          line(out, fmt::format("  nearest at {:.10g}: point {}, distance {:.10g}", p["at"].get<double>(),
                                numbers(p["point"]), p["distance"].get<double>()));
      if (c.contains("values"))
        for (const Json& p : c["values"])
          line(out, fmt::format("  at {:.10g}: point {}; first {}; second {}; curvature {:.6g}", p["at"].get<double>(),
                                numbers(p["point"]), numbers(p["first"]), numbers(p["second"]),
                                p["curvature"].get<double>()));
    } else if (c.contains("visited_cells")) {
      line(out, fmt::format("  {}; lines {} ({} closed), vertices {}, cells without a certificate {}, doubtful {}",
                            c["polynomial"].get<bool>() ? "polynomial" : "by intervals", c["lines"].get<std::size_t>(),
                            c["closed_lines"].get<std::size_t>(), c["vertices"].get<std::size_t>(),
                            c["unresolved_cells"].get<std::size_t>(), c["doubtful_cells"].get<std::size_t>()));
      line(out, fmt::format("  looked at {} cells, {:.3g} % of {}; kept {}", c["visited_cells"].get<std::size_t>(),
                            100.0 * static_cast<double>(c["visited_cells"].get<std::size_t>()) /
                                static_cast<double>(c["grid_cells"].get<std::size_t>()),
                            c["grid_cells"].get<std::size_t>(), c["kept_cells"].get<std::size_t>()));
    } else {
      line(out, fmt::format("  lines {}, vertices {}, evaluations {}{}", c["lines"].get<std::size_t>(),
                            c["vertices"].get<std::size_t>(), c["evaluations"].get<std::size_t>(),
                            c["breaks"].empty() ? "" : ", breaks at " + numbers(c["breaks"])));
    }
  }
  if (report.contains("intersections"))
    for (const Json& p : report["intersections"])
      line(out, fmt::format("curves[{}] meets curves[{}] at {}: point {}{}", p["curves"][0].get<int>(),
                            p["curves"][1].get<int>(), numbers(p["at"]), numbers(p["point"]),
                            p.contains("overlap") ? " (a stretch in common)" : ""));
  return out;
}

}  // namespace retalho::app
