// Reading and writing of the JSON form; every error names its place.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/curve/document.h"

namespace retalho {

namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw BadInput(fmt::format("{}: {}", where, what), {}, where);
}

/// The keys that each kind has beside "kind", "name" and "dimension".
struct KindKeys {
  CurveKind kind;
  std::vector<std::string> keys;
};
const std::vector<KindKeys>& kinds() {
  static const std::vector<KindKeys> all = {
      {CurveKind::bezier, {"points", "degree", "weights", "breaks", "closed"}},
      {CurveKind::chain, {"segments", "breaks", "closed"}},
      {CurveKind::hermite, {"points", "tangents", "seconds", "breaks", "closed"}},
      {CurveKind::power, {"coefficients", "interval"}},
      {CurveKind::bspline, {"points", "degree", "knots", "weights", "closed"}},
      {CurveKind::spline, {"points", "ends", "parameters", "tangents", "closed"}},
      {CurveKind::catmull_rom, {"points", "parameters", "closed"}},
      {CurveKind::lagrange, {"points", "parameters"}},
      {CurveKind::polyline, {"points", "closed"}},
      {CurveKind::implicit_form, {"f", "box"}},
      {CurveKind::explicit_form, {"f", "from", "to"}},
  };
  return all;
}

double number(const Json& v, const std::string& where) {
  if (!v.is_number()) fail(where, fmt::format("expected a number, got {}", v.type_name()));
  const double d = v.get<double>();
  // Squares and cubes of lengths have to stay finite.
  if (!(std::abs(d) <= 1e100)) fail(where, fmt::format("the number {} is too large: scale the curves below 1e100", d));
  return d;
}

std::vector<double> numbers(const Json& v, const std::string& where) {
  if (!v.is_array()) fail(where, fmt::format("expected an array of numbers, got {}", v.type_name()));
  std::vector<double> out;
  for (std::size_t i = 0; i < v.size(); ++i) out.push_back(number(v[i], fmt::format("{}[{}]", where, i)));
  return out;
}

Vec3 point(const Json& v, const std::string& where, int& dimension) {
  if (!v.is_array())
    fail(where,
         fmt::format("expected {} numbers, got {}", dimension ? std::to_string(dimension) : "2 or 3", v.type_name()));
  if (dimension == 0 && (v.size() == 2 || v.size() == 3)) dimension = static_cast<int>(v.size());
  if (dimension == 0) fail(where, fmt::format("expected 2 or 3 numbers, got {}", v.size()));
  if (v.size() != static_cast<std::size_t>(dimension))
    fail(where, fmt::format("expected {} numbers, got {}", dimension, v.size()));
  return {number(v[0], where + "[0]"), number(v[1], where + "[1]"), dimension == 3 ? number(v[2], where + "[2]") : 0.0};
}

std::vector<Vec3> point_list(const Json& v, const std::string& where, int& dimension) {
  if (!v.is_array()) fail(where, fmt::format("expected an array of points, got {}", v.type_name()));
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < v.size(); ++i) out.push_back(point(v[i], fmt::format("{}[{}]", where, i), dimension));
  return out;
}

std::string text(const Json& v, const std::string& where) {
  if (!v.is_string()) fail(where, fmt::format("expected a text, got {}", v.type_name()));
  return v.get<std::string>();
}

template <typename Enum>
Enum choice(const Json& v, const std::string& where, std::initializer_list<std::pair<const char*, Enum>> names) {
  const std::string given = text(v, where);
  std::string list;
  for (const auto& [name, value] : names) {
    if (given == name) return value;
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", name);
  }
  fail(where, fmt::format("\"{}\" is none of {}", given, list));
}

void parse_segments(const Json& v, const std::string& where, CurveSpec& spec, int& dimension) {
  if (!v.is_array() || v.empty()) fail(where, "expected an array of segments");
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::string at = fmt::format("{}[{}]", where, i);
    if (!v[i].is_object() || !v[i].contains("points"))
      fail(at, "expected an object with \"points\" (and perhaps \"weights\")");
    const auto points = point_list(v[i]["points"], at + ".points", dimension);
    const auto weights = v[i].contains("weights") ? numbers(v[i]["weights"], at + ".weights") : std::vector<double>();
    try {
      spec.chain.append(points, 1, weights);
    } catch (const Error& error) {
      fail(at, error.what());
    }
  }
}

CurveSpec parse_curve(const Json& v, const std::string& where) {
  if (!v.is_object()) fail(where, fmt::format("expected an object, got {}", v.type_name()));
  if (!v.contains("kind")) fail(where, "\"kind\" is missing");
  const std::string kind = text(v["kind"], where + ".kind");
  const auto found =
      std::find_if(kinds().begin(), kinds().end(), [&](const KindKeys& k) { return kind == curve_kind_name(k.kind); });
  if (found == kinds().end()) {
    std::string list;
    for (const KindKeys& k : kinds())
      list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", curve_kind_name(k.kind));
    fail(where + ".kind", fmt::format("\"{}\" is none of {}", kind, list));
  }
  CurveSpec spec;
  spec.kind = found->kind;
  int dimension = 0;
  if (v.contains("dimension")) {
    const double d = number(v["dimension"], where + ".dimension");
    if (d != 2 && d != 3) fail(where + ".dimension", fmt::format("expected 2 or 3, got {}", d));
    dimension = static_cast<int>(d);
  }
  for (const auto& [key, value] : v.items()) {
    const std::string at = where + "." + key;
    if (key == "kind" || key == "dimension") continue;
    if (key == "name") {
      spec.name = text(value, at);
      continue;
    }
    if (std::find(found->keys.begin(), found->keys.end(), key) == found->keys.end())
      fail(at, fmt::format("a curve of kind \"{}\" has no such key; it has {}", kind, fmt::join(found->keys, ", ")));
    if (key == "points" || key == "coefficients")
      spec.points = point_list(value, at, dimension);
    else if (key == "tangents")
      spec.tangents = point_list(value, at, dimension);
    else if (key == "seconds")
      spec.seconds = point_list(value, at, dimension);
    else if (key == "segments")
      parse_segments(value, at, spec, dimension);
    else if (key == "weights")
      spec.weights = numbers(value, at);
    else if (key == "knots")
      spec.knots = numbers(value, at);
    else if (key == "breaks")
      spec.breaks = numbers(value, at);
    else if (key == "from")
      spec.from = number(value, at);
    else if (key == "to")
      spec.to = number(value, at);
    else if (key == "f")
      spec.f = text(value, at);
    else if (key == "closed") {
      if (!value.is_boolean()) fail(at, fmt::format("expected true or false, got {}", value.type_name()));
      spec.closed = value.get<bool>();
    } else if (key == "degree") {
      if (!value.is_number_integer() || value.get<double>() < 1 || value.get<double>() > kMaxCurveDegree)
        fail(at, fmt::format("expected a whole number from 1 to {}, got {}", kMaxCurveDegree, value.dump()));
      spec.degree = value.get<int>();
    } else if (key == "interval") {
      spec.breaks = numbers(value, at);
      if (spec.breaks.size() != 2 || !(spec.breaks[0] < spec.breaks[1])) fail(at, "expected two ascending numbers");
    } else if (key == "ends")
      spec.ends = choice<SplineEnds>(value, at,
                                     {{"not-a-knot", SplineEnds::not_a_knot},
                                      {"natural", SplineEnds::natural},
                                      {"clamped", SplineEnds::clamped},
                                      {"periodic", SplineEnds::periodic}});
    else if (key == "parameters")
      spec.parameters = choice<Parameters>(value, at,
                                           {{"uniform", Parameters::uniform},
                                            {"centripetal", Parameters::centripetal},
                                            {"chord", Parameters::chord},
                                            {"x", Parameters::x}});
    else if (key == "box") {
      spec.box = numbers(value, at);
      if (spec.box.size() != 4 || !(spec.box[0] < spec.box[2]) || !(spec.box[1] < spec.box[3]))
        fail(at, "expected xmin, ymin, xmax, ymax with xmin < xmax and ymin < ymax");
    }
  }
  const auto need = [&](const char* key) {
    if (!v.contains(key))
      fail(where,
           fmt::format("\"{}\" is missing; a curve of kind \"{}\" has {}", key, kind, fmt::join(found->keys, ", ")));
  };
  for (const char* key : {"points", "coefficients", "segments", "f", "box", "from", "to"})
    if (std::find(found->keys.begin(), found->keys.end(), key) != found->keys.end()) need(key);
  if (spec.kind == CurveKind::hermite) need("tangents");
  if (spec.kind == CurveKind::spline && spec.ends == SplineEnds::clamped) {
    need("tangents");
    if (spec.tangents.size() != 2)
      fail(where + ".tangents", fmt::format("expected the 2 end tangents, got {}", spec.tangents.size()));
  }
  if (spec.kind == CurveKind::explicit_form && !(spec.from < spec.to))
    fail(where + ".to", fmt::format("{} is not above \"from\", {}", spec.to, spec.from));
  spec.dimension = dimension == 0 ? 2 : dimension;
  return spec;
}

Json json_of(const std::vector<Vec3>& points, int dimension) {
  Json out = Json::array();
  for (const Vec3& p : points) out.push_back(dimension == 3 ? Json{p.x, p.y, p.z} : Json{p.x, p.y});
  return out;
}

Json json_of(const CurveSpec& s) {
  Json v;
  v["kind"] = curve_kind_name(s.kind);
  if (!s.name.empty()) v["name"] = s.name;
  const int d = s.dimension;
  if (s.kind == CurveKind::implicit_form || s.kind == CurveKind::explicit_form) {
    v["f"] = s.f;
    if (s.kind == CurveKind::implicit_form)
      v["box"] = s.box;
    else
      v["from"] = s.from, v["to"] = s.to;
    return v;
  }
  if (s.degree > 0) v["degree"] = s.degree;
  if (s.kind == CurveKind::spline) v["ends"] = spline_ends_name(s.ends);
  if (s.parameters) v["parameters"] = parameters_name(*s.parameters);
  if (s.closed) v["closed"] = true;
  if (!s.knots.empty()) v["knots"] = s.knots;
  if (!s.breaks.empty()) v[s.kind == CurveKind::power ? "interval" : "breaks"] = s.breaks;
  if (s.kind == CurveKind::chain) {
    Json segments = Json::array();
    for (std::size_t i = 0; i < s.chain.segment_count(); ++i) {
      const CurveSegment g = s.chain.segment(i);
      Json one{{"points", json_of({g.points.begin(), g.points.end()}, d)}};
      if (g.rational()) one["weights"] = std::vector<double>(g.weights.begin(), g.weights.end());
      segments.push_back(std::move(one));
    }
    v["segments"] = std::move(segments);
  } else {
    v[s.kind == CurveKind::power ? "coefficients" : "points"] = json_of(s.points, d);
  }
  if (!s.tangents.empty()) v["tangents"] = json_of(s.tangents, d);
  if (!s.seconds.empty()) v["seconds"] = json_of(s.seconds, d);
  if (!s.weights.empty()) v["weights"] = s.weights;
  return v;
}

/// One curve a line: readable, and small differences between files stay small.
std::string lines(const Json& document) {
  std::string out = "{\"curves\": [";
  bool first = true;
  for (const Json& curve : document) {
    out += first ? "\n  " : ",\n  ";
    out += curve.dump();
    first = false;
  }
  return out + "\n]}\n";
}

}  // namespace

CurveDocument parse_curves(std::string_view json, const std::string& file) {
  try {
    const Json v = Json::parse(json.begin(), json.end());
    if (!v.is_object() || !v.contains("curves"))
      throw BadInput("expected an object with the key \"curves\", an array", {}, "curves");
    const Json& list = v["curves"];
    if (!list.is_array()) fail("curves", fmt::format("expected an array, got {}", list.type_name()));
    CurveDocument document;
    for (std::size_t i = 0; i < list.size(); ++i)
      document.curves.push_back(parse_curve(list[i], fmt::format("curves[{}]", i)));
    return document;
  } catch (const Json::parse_error& error) {
    const std::size_t at = std::min(json.size(), error.byte > 0 ? error.byte - 1 : 0);
    const auto line = 1 + std::count(json.begin(), json.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::size_t start = json.substr(0, at).rfind('\n');
    const std::size_t column = start == std::string_view::npos ? at + 1 : at - start;
    const std::string where = fmt::format("line {}, column {}", line, column);
    throw BadInput(fmt::format("not JSON ({})", where), file, where);
  } catch (const Json::exception& error) {
    throw BadInput(fmt::format("not usable JSON: {}", error.what()), file);
  } catch (const BadInput& error) {
    throw BadInput(error.what(), file, error.where());
  }
}

CurveDocument read_curves(const std::string& path) {
  return parse_curves(read_file(path), path);
}

std::string to_json(const CurveDocument& document) {
  Json list = Json::array();
  for (const CurveSpec& spec : document.curves) list.push_back(json_of(spec));
  return lines(list);
}

}  // namespace retalho
