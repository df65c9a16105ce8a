#include "retalho/curve/intersect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "retalho/curve/edit.h"
#include "retalho/curve/measure.h"

namespace retalho {

namespace {

/// A part of a segment: its control points (projected: hull property) and where it lies.
struct Piece {
  std::vector<Vec3> points;
  std::vector<double> weights;
  std::size_t segment = 0;
  double from = 0, to = 1;  // local parameters of the segment
  Vec3 low, high;

  void measure() {
    low = high = points[0];
    for (const Vec3& p : points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  double extent() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

Piece piece_of(const CurveSegment& s, std::size_t index) {
  Piece p{{s.points.begin(), s.points.end()}, {s.weights.begin(), s.weights.end()}, index, 0, 1, {}, {}};
  p.measure();
  return p;
}

std::pair<Piece, Piece> halves(const Piece& p) {
  const Curve two = split_segment({p.points, p.weights, p.from, p.to}, 0.5);
  std::pair<Piece, Piece> out{piece_of(two.segment(0), p.segment), piece_of(two.segment(1), p.segment)};
  const double middle = 0.5 * (p.from + p.to);
  out.first.from = p.from;
  out.first.to = out.second.from = middle;
  out.second.to = p.to;
  return out;
}

bool boxes_apart(const Piece& a, const Piece& b, double margin) {
  return a.low.x > b.high.x + margin || b.low.x > a.high.x + margin || a.low.y > b.high.y + margin ||
         b.low.y > a.high.y + margin || a.low.z > b.high.z + margin || b.low.z > a.high.z + margin;
}

/// In the plane: all of b on one side of the strip around a's chord that holds a.
bool strip_apart(const Piece& a, const Piece& b, double margin) {
  const Vec3 chord = a.points.back() - a.points.front();
  const double length = norm(chord);
  if (length == 0) return false;
  const auto height = [&](Vec3 p) { return cross(chord, p - a.points.front()).z / length; };
  double a_low = 0, a_high = 0, b_low = 1e300, b_high = -1e300;
  for (const Vec3& p : a.points) a_low = std::min(a_low, height(p)), a_high = std::max(a_high, height(p));
  for (const Vec3& p : b.points) b_low = std::min(b_low, height(p)), b_high = std::max(b_high, height(p));
  return b_low > a_high + margin || a_low > b_high + margin;
}

struct Contact {
  double s = 0, t = 0;
  double distance = 0;
};

/// The nearest points of two segments near (s, t): Gauss-Newton with a little damping, inside of [0, 1]^2.
Contact polish(const CurveSegment& a, const CurveSegment& b, double s, double t) {
  double damping = 1e-12;
  CurveJet p = evaluate_jet(a, s), q = evaluate_jet(b, t);
  double best = norm2(p.point - q.point);
  for (int step = 0; step < 80 && damping < 1e8; ++step) {
    const Vec3 d = p.point - q.point;
    const double aa = norm2(p.first), bb = norm2(q.first), ab = dot(p.first, q.first);
    const double ra = -dot(d, p.first), rb = dot(d, q.first);
    const double m = damping * (aa + bb) + 1e-300, det = (aa + m) * (bb + m) - ab * ab;
    if (!(det > 0)) break;
    const double s1 = std::clamp(s + ((bb + m) * ra + ab * rb) / det, 0.0, 1.0);
    const double t1 = std::clamp(t + (ab * ra + (aa + m) * rb) / det, 0.0, 1.0);
    if (s1 == s && t1 == t) break;
    const CurveJet p1 = evaluate_jet(a, s1), q1 = evaluate_jet(b, t1);
    const double now = norm2(p1.point - q1.point);
    if (now < best || (now == best && damping <= 1e-12)) {
      const bool settled = std::abs(s1 - s) + std::abs(t1 - t) < 1e-15;
      s = s1, t = t1, p = p1, q = q1, best = now;
      damping = std::max(damping / 10, 1e-15);
      if (settled || best == 0) break;
    } else {
      damping = std::max(damping, 1e-12) * 10;
    }
  }
  return {s, t, std::sqrt(best)};
}

double global_parameter(const CurveSegment& s, double t) {
  return t == 1 ? s.to : s.from + t * (s.to - s.from);
}

class Search {
 public:
  Search(const Curve& a, const Curve& b, double tolerance, bool plane)
      : a_(a), b_(b), tolerance_(tolerance), plane_(plane) {}

  /// Every contact of two pieces.
  void pair(const Piece& a, const Piece& b) {
    if (boxes_apart(a, b, tolerance_)) return;
    if (plane_ && (strip_apart(a, b, tolerance_) || strip_apart(b, a, tolerance_))) return;
    constexpr double kSmall = 1.0 / (1 << 17);
    const bool small_a = a.to - a.from <= kSmall || a.extent() <= tolerance_,
               small_b = b.to - b.from <= kSmall || b.extent() <= tolerance_;
    if (small_a && small_b) {
      candidate(a, b);
      return;
    }
    if (!small_a && (small_b || a.extent() >= b.extent())) {
      const auto [left, right] = halves(a);
      pair(left, b);
      pair(right, b);
    } else {
      const auto [left, right] = halves(b);
      pair(a, left);
      pair(a, right);
    }
  }

  /// A stretch in common has its ends at ends of one of the pieces. True when there is one: then nothing else is looked
  /// for.
  bool overlap(const Piece& pa, const Piece& pb) {
    const CurveSegment a = a_.segment(pa.segment), b = b_.segment(pb.segment);
    Curve one_a, one_b;
    one_a.append(pa.points, 1, pa.weights);
    one_b.append(pb.points, 1, pb.weights);
    std::vector<std::pair<double, double>> ends;  // local in the pieces
    const auto try_end = [&](double s, Vec3 p, bool of_a) {
      const CurvePoint near = closest_point(of_a ? one_b : one_a, p);
      if (near.value <= tolerance_) ends.emplace_back(of_a ? s : near.at, of_a ? near.at : s);
    };
    try_end(0, pa.points.front(), true);
    try_end(1, pa.points.back(), true);
    try_end(0, pb.points.front(), false);
    try_end(1, pb.points.back(), false);
    if (ends.size() < 2) return false;
    std::sort(ends.begin(), ends.end());
    const auto first = ends.front(), last = ends.back();
    if (last.first - first.first < 1e-6) return false;
    for (int k = 1; k < 8; ++k) {
      const double s = first.first + (last.first - first.first) * k / 8;
      if (closest_point(one_b, evaluate(one_a.segment(0), s)).value > tolerance_) return false;
    }
    const auto local = [](const Piece& p, double t) { return p.from + t * (p.to - p.from); };
    for (const auto& [s, t] : {first, last})
      found_.push_back(
          {global_parameter(a, local(pa, s)), global_parameter(b, local(pb, t)), evaluate(a, local(pa, s)), 0, true});
    return true;
  }

  std::vector<Crossing>& found() { return found_; }

 private:
  void candidate(const Piece& pa, const Piece& pb) {
    const CurveSegment a = a_.segment(pa.segment), b = b_.segment(pb.segment);
    const Contact c = polish(a, b, 0.5 * (pa.from + pa.to), 0.5 * (pb.from + pb.to));
    if (c.distance <= tolerance_)
      found_.push_back({global_parameter(a, c.s), global_parameter(b, c.t), evaluate(a, c.s), c.distance, false});
  }

  const Curve& a_;
  const Curve& b_;
  double tolerance_;
  bool plane_;
  std::vector<Crossing> found_;
};

/// Sorted, each contact once. Where curves only touch, the parameters are known to the root of the precision.
std::vector<Crossing> unique(std::vector<Crossing> all, double range_a, double range_b) {
  std::sort(all.begin(), all.end(), [](const Crossing& p, const Crossing& q) {
    return p.first != q.first ? p.first < q.first : p.second < q.second;
  });
  constexpr double kSame = 3e-7;
  std::vector<Crossing> result;
  for (const Crossing& c : all) {
    bool again = false;
    for (std::size_t i = result.size(); i-- > 0 && c.first - result[i].first <= kSame * range_a;)
      if (std::abs(c.second - result[i].second) <= kSame * range_b) {
        again = true;
        if (c.distance < result[i].distance && !result[i].overlap) result[i] = c;
        break;
      }
    if (!again) result.push_back(c);
  }
  return result;
}

/// Parts whose direction stays within a half-plane: such a part never meets itself. Cusps end in parts too small to
/// matter.
void simple_parts(const Piece& p, int level, std::vector<Piece>& out) {
  Vec3 axis;
  for (std::size_t i = 0; i + 1 < p.points.size(); ++i) axis = axis + (p.points[i + 1] - p.points[i]);
  bool one_way = true;
  for (std::size_t i = 0; i + 1 < p.points.size(); ++i) {
    const Vec3 d = p.points[i + 1] - p.points[i];
    if (!(dot(d, axis) > 0) && norm2(d) > 0) one_way = false;
  }
  if (one_way || level >= 16 || p.points.size() < 3) {
    out.push_back(p);
    return;
  }
  const auto [left, right] = halves(p);
  simple_parts(left, level + 1, out);
  simple_parts(right, level + 1, out);
}

bool together_one_way(const Piece& a, const Piece& b) {
  const Vec3 axis = (a.points.back() - a.points.front()) + (b.points.back() - b.points.front());
  for (const Piece* p : {&a, &b})
    for (std::size_t i = 0; i + 1 < p->points.size(); ++i) {
      const Vec3 d = p->points[i + 1] - p->points[i];
      if (!(dot(d, axis) > 0) && norm2(d) > 0) return false;
    }
  return true;
}

}  // namespace

std::vector<Crossing> intersections(const Curve& a, const Curve& b, const CrossingOptions& options) {
  if (a.empty() || b.empty()) return {};
  const double size = std::max(control_size(a.points), control_size(b.points));
  Search search(a, b, options.tolerance * size, a.dimension == 2 && b.dimension == 2);
  std::vector<Piece> of_b;
  for (std::size_t j = 0; j < b.segment_count(); ++j) of_b.push_back(piece_of(b.segment(j), j));
  for (std::size_t i = 0; i < a.segment_count(); ++i) {
    const Piece p = piece_of(a.segment(i), i);
    for (const Piece& q : of_b) {
      if (boxes_apart(p, q, options.tolerance * size)) continue;
      if (!search.overlap(p, q)) search.pair(p, q);
    }
  }
  return unique(std::move(search.found()), a.end() - a.begin(), b.end() - b.begin());
}

std::vector<Crossing> self_intersections(const Curve& curve, const CrossingOptions& options) {
  if (curve.empty()) return {};
  const double size = control_size(curve.points), range = curve.end() - curve.begin();
  Search search(curve, curve, options.tolerance * size, curve.dimension == 2);
  std::vector<Piece> parts;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) simple_parts(piece_of(curve.segment(i), i), 0, parts);
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = i + 1; j < parts.size(); ++j) {
      if (boxes_apart(parts[i], parts[j], options.tolerance * size)) continue;
      if (j == i + 1 && together_one_way(parts[i], parts[j])) continue;
      if (parts[i].segment != parts[j].segment && search.overlap(parts[i], parts[j])) continue;
      search.pair(parts[i], parts[j]);
    }
  // A point is no crossing with itself: neighbours meet at their join, and the ends of a closed curve meet. What is
  // nearer along the curve than the resolution of the search, on the way from one parameter to the other, is such a
  // join.
  auto& found = search.found();
  const double near = 1e-4 * range;
  std::erase_if(found, [&](Crossing& c) {
    if (c.first > c.second) std::swap(c.first, c.second);
    const double gap = c.second - c.first;
    if (curve.closed && range - gap <= 1e-9 * range) return true;
    if (gap <= 1e-9 * range) return true;
    // Close parameters: a tiny loop crosses itself at an angle, while rounding around a join finds no angle.
    if (gap <= near || (curve.closed && range - gap <= near)) {
      const double polygon = arc_length(curve, c.first, c.second, 1e-6);
      const double other = curve.closed ? arc_length(curve, 1e-6) - polygon : polygon;
      return std::min(polygon, other) <= 10 * options.tolerance * size;
    }
    return false;
  });
  return unique(std::move(found), range, range);
}

}  // namespace retalho
