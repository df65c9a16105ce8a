#include "retalho/curve/document.h"

#include <fmt/format.h>

#include <cmath>

#include "retalho/core/error.h"
#include "retalho/curve/convert.h"
#include "retalho/curve/edit.h"

namespace retalho {

namespace {

/// Adds the place to an error that knows only the field.
[[noreturn]] void rethrow_at(const Error& error, const std::string& where) {
  const std::string place = error.where().empty() ? where : where.empty() ? error.where() : where + "." + error.where();
  throw BadInput(place.empty() ? error.what() : fmt::format("{}: {}", place, error.what()), error.file(), place);
}

bool same_shape(const Curve& curve) {
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    if (s.degree() != curve.degree() || s.degree() < 1) return false;
    if (i == 0) continue;
    const CurveSegment before = curve.segment(i - 1);
    if (!(before.points.back() == s.points.front())) return false;
    if (s.rational() && before.weights.back() != s.weights.front()) return false;
  }
  return true;
}

Curve with_breaks(Curve curve, const std::vector<double>& breaks) {
  if (breaks.empty()) return curve;
  if (breaks.size() != curve.segment_count() + 1)
    throw BadInput(fmt::format("{} parameters for {} segments: {} are needed", breaks.size(), curve.segment_count(),
                               curve.segment_count() + 1),
                   {}, "breaks");
  for (std::size_t i = 1; i < breaks.size(); ++i)
    if (!(breaks[i] > breaks[i - 1]))
      throw BadInput(fmt::format("{} after {}: parameters must ascend", breaks[i], breaks[i - 1]), {},
                     fmt::format("breaks[{}]", i));
  curve.breaks = breaks;
  return curve;
}

Curve convert(const CurveSpec& spec) {
  const int d = spec.dimension;
  const auto parameters =
      spec.parameters.value_or(spec.kind == CurveKind::lagrange ? Parameters::uniform : Parameters::centripetal);
  switch (spec.kind) {
    case CurveKind::bezier: {
      const int degree = spec.degree > 0 ? spec.degree : static_cast<int>(spec.points.size()) - 1;
      Curve curve = make_bezier(spec.points, degree, d, spec.weights);
      curve.closed = spec.closed;
      return with_breaks(std::move(curve), spec.breaks);
    }
    case CurveKind::chain: {
      Curve curve = spec.chain;
      curve.dimension = d;
      curve.closed = spec.closed;
      return with_breaks(std::move(curve), spec.breaks);
    }
    case CurveKind::hermite:
      return spec.seconds.empty()
                 ? from_hermite(spec.points, spec.tangents, d, spec.breaks, spec.closed)
                 : from_hermite_quintic(spec.points, spec.tangents, spec.seconds, d, spec.breaks, spec.closed);
    case CurveKind::power:
      return from_power(spec.points, spec.breaks.empty() ? 0 : spec.breaks.front(),
                        spec.breaks.empty() ? 1 : spec.breaks.back(), d);
    case CurveKind::bspline: {
      BSpline s{spec.degree > 0 ? spec.degree : 3, d, spec.knots, spec.points, spec.weights};
      if (s.knots.empty()) {
        if (spec.closed)
          s = closed_bspline(spec.points, s.degree, d);
        else
          s.knots = clamped_knots(s.points.size(), s.degree);
        if (spec.closed && !spec.weights.empty()) {
          s.weights = spec.weights;
          for (std::size_t i = 0; s.weights.size() < s.points.size(); ++i) s.weights.push_back(spec.weights[i]);
        }
      }
      Curve curve = to_curve(s);
      curve.closed = spec.closed;
      return curve;
    }
    case CurveKind::spline:
      return interpolate_points(spec.points, d,
                                {.ends = spec.ends,
                                 .parameters = parameters,
                                 .closed = spec.closed,
                                 .first_tangent = spec.tangents.empty() ? Vec3{} : spec.tangents.front(),
                                 .last_tangent = spec.tangents.empty() ? Vec3{} : spec.tangents.back()});
    case CurveKind::catmull_rom:
      return catmull_rom(spec.points, d, spec.closed,
                         parameters == Parameters::uniform ? 0.0
                         : parameters == Parameters::chord ? 1.0
                                                           : 0.5);
    case CurveKind::lagrange:
      return lagrange_curve(spec.points, d, parameters);
    case CurveKind::polyline:
      return make_polyline(spec.points, d, spec.closed);
    case CurveKind::implicit_form:
    case CurveKind::explicit_form:
      break;
  }
  throw UsageError(fmt::format("a curve of kind \"{}\" has no exact parametric form: draw it, or flatten it",
                               curve_kind_name(spec.kind)));
}

}  // namespace

const char* curve_kind_name(CurveKind kind) {
  switch (kind) {
    case CurveKind::bezier:
      return "bezier";
    case CurveKind::chain:
      return "chain";
    case CurveKind::hermite:
      return "hermite";
    case CurveKind::power:
      return "power";
    case CurveKind::bspline:
      return "bspline";
    case CurveKind::spline:
      return "spline";
    case CurveKind::catmull_rom:
      return "catmull-rom";
    case CurveKind::lagrange:
      return "lagrange";
    case CurveKind::polyline:
      return "polyline";
    case CurveKind::implicit_form:
      return "implicit";
    case CurveKind::explicit_form:
      return "explicit";
  }
  return "";
}

Curve to_curve(const CurveSpec& spec, const std::string& where) {
  try {
    return convert(spec);
  } catch (const UsageError&) {
    throw;
  } catch (const Error& error) {
    rethrow_at(error, where);
  }
}

CurveSpec to_spec(const Curve& curve) {
  CurveSpec spec;
  spec.dimension = curve.dimension;
  spec.closed = curve.closed;
  bool counted = true;
  for (std::size_t i = 0; i < curve.breaks.size(); ++i) counted = counted && curve.breaks[i] == static_cast<double>(i);
  if (!counted) spec.breaks = curve.breaks;
  if (!curve.empty() && same_shape(curve)) {
    spec.kind = CurveKind::bezier;
    spec.degree = curve.degree();
    for (std::size_t i = 0; i < curve.segment_count(); ++i) {
      const CurveSegment s = curve.segment(i);
      const std::ptrdiff_t skip = i > 0 ? 1 : 0;
      spec.points.insert(spec.points.end(), s.points.begin() + skip, s.points.end());
      if (s.rational()) spec.weights.insert(spec.weights.end(), s.weights.begin() + skip, s.weights.end());
    }
    return spec;
  }
  spec.kind = CurveKind::chain;
  spec.chain = curve;
  return spec;
}

}  // namespace retalho
