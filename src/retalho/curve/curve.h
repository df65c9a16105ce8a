// A parametric curve in the plane or in space: a chain of Bézier segments of any degree, polynomial or rational. This
// is the hub of the room: every other form (Hermite, B-spline, NURBS, power basis, interpolating splines) is converted
// to it exactly, and every question is answered on it.
//
// Segment i runs over the parameters [breaks[i], breaks[i + 1]]; consecutive segments normally meet, but a gap is
// allowed (curve/continuity.h reports it). In the plane z is 0. Weights, where present, are positive.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "retalho/core/vec.h"

namespace retalho {

inline constexpr int kMaxCurveDegree = 63;

/// One segment, seen without copying. Valid as long as its curve is not changed.
struct CurveSegment {
  std::span<const Vec3> points;     ///< degree + 1 control points
  std::span<const double> weights;  ///< empty: polynomial
  double from = 0, to = 1;          ///< the curve's parameters at its ends
  int degree() const { return static_cast<int>(points.size()) - 1; }
  bool rational() const { return !weights.empty(); }
};

struct Curve {
  int dimension = 2;                       ///< 2 or 3
  bool closed = false;                     ///< the last point joins the first
  std::vector<Vec3> points;                ///< control points of all segments, one segment after the other
  std::vector<double> weights;             ///< as long as `points`, or empty for a polynomial curve
  std::vector<std::uint32_t> first = {0};  ///< segment i owns points [first[i], first[i + 1])
  std::vector<double> breaks = {0};        ///< ascending parameters, one more than segments

  std::size_t segment_count() const { return first.size() - 1; }
  bool empty() const { return first.size() < 2; }
  bool rational() const { return !weights.empty(); }
  int degree() const;  ///< the largest degree of a segment; 0 for an empty curve
  CurveSegment segment(std::size_t i) const;
  double begin() const { return breaks.front(); }
  double end() const { return breaks.back(); }

  /// Adds a segment that ends at parameter breaks.back() + length. Polynomial and rational segments mix: missing
  /// weights are 1. Throws BadInput: no points, degree over 63, length <= 0, weights of another count or not positive.
  void append(std::span<const Vec3> segment_points, double length = 1, std::span<const double> segment_weights = {});
};

/// A chain from points that share their ends: degree * n + 1 points make n segments. Throws BadInput otherwise.
Curve make_bezier(std::span<const Vec3> points, int degree, int dimension, std::span<const double> weights = {});
/// One segment in the plane.
Curve make_bezier(std::span<const Vec2> points);
/// Straight segments through the points.
Curve make_polyline(std::span<const Vec3> points, int dimension, bool closed = false);

/// Point and derivatives by a parameter.
struct CurveJet {
  Vec3 point, first, second, third;
};

/// Point of a segment at local parameter t in [0, 1] (outside: extrapolated).
Vec3 evaluate(const CurveSegment& segment, double t);
/// Point and derivatives by the local parameter t.
CurveJet evaluate_jet(const CurveSegment& segment, double t);

/// At a join: which segment answers.
enum class Side { left, right };
/// Which segment holds parameter u, and the local parameter there (u outside is clamped).
std::pair<std::size_t, double> locate(const Curve& curve, double u, Side side = Side::right);
Vec3 evaluate(const Curve& curve, double u, Side side = Side::right);
/// Point and derivatives by the curve's parameter u.
CurveJet evaluate_jet(const Curve& curve, double u, Side side = Side::right);

/// The triangle of de Casteljau at t: row r has degree - r + 1 points, the last row is the point itself.
/// Rational segments: the projected points.
std::vector<std::vector<Vec3>> casteljau_rows(const CurveSegment& segment, double t);

/// Diagonal of the box of the control points: the size that tolerances are relative to.
double control_size(std::span<const Vec3> points);

}  // namespace retalho
