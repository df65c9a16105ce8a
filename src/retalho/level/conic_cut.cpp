#include "retalho/level/conic_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "retalho/level/cell_walk.h"

namespace retalho {
namespace {

constexpr double kTouch = 1e-12;  // of a segment's parameter: what is shorter is no part of its own

/// A conic with weights 1, weight, 1.
struct Conic {
  std::array<Vec2, 3> points;
  double weight;
};

/// A place of a conic where it passes the side of a cell.
struct Passing {
  double t;
  bool vertical;
  double line;  ///< x of a vertical side, y of a horizontal one
};

/// Blossom: the product of the line through `t` and the polar of `u`, with its weight as z.
Vec3 polar(const Conic& c, double t, double u) {
  const double first = (1 - t) * (1 - u), middle = c.weight * ((1 - t) * u + t * (1 - u)), last = t * u;
  const Vec2 at = first * c.points[0] + middle * c.points[1] + last * c.points[2];
  return {at.x, at.y, first + middle + last};
}

/// The part from t to u, its weights again 1, weight, 1.
Conic part_of(const Conic& c, double t, double u) {
  if (t == 0 && u == 1) return c;
  const Vec3 a = polar(c, t, t), b = polar(c, t, u), d = polar(c, u, u);
  const auto place = [](Vec3 h) { return Vec2{h.x / h.z, h.y / h.z}; };
  Conic part{{place(a), place(b), place(d)}, b.z / std::sqrt(a.z * d.z)};
  if (t == 0) part.points[0] = c.points[0];
  if (u == 1) part.points[2] = c.points[2];
  return part;
}

/// Roots inside (0, 1) of the quadratic with these Bernstein coefficients, ascending.
template <class Use>
void each_root(double b0, double b1, double b2, const Use& use) {
  const double a = b0 - 2 * b1 + b2, half = b1 - b0;  // a t^2 + 2 half t + b0
  const double root = half * half - a * b0;
  if (!(root >= 0)) return;
  const double q = -(half + std::copysign(std::sqrt(root), half));  // no cancellation
  std::array<double, 2> t{a != 0 ? q / a : 2, q != 0 ? b0 / q : 2};
  if (t[0] > t[1]) std::swap(t[0], t[1]);
  for (const double at : t)
    if (at > 0 && at < 1) use(at);
}

class Cutter {
 public:
  explicit Cutter(const GridDomain& grid) : grid_(grid) {}

  /// Appends the parts of `line` to `out`.
  void cut(ConicLine line, std::vector<ConicLine>& out) {
    runs_.clear();
    was_cut_ = inside_ = false;
    for (std::size_t i = 0; i < line.curve.segment_count(); ++i) {
      const CurveSegment s = line.curve.segment(i);
      const auto flat = [](Vec3 p) { return Vec2{p.x, p.y}; };
      add({{flat(s.points[0]), flat(s.points[1]), flat(s.points[2])}, s.rational() ? s.weights[1] : 1.0});
    }
    if (!was_cut_) {
      if (inside_) out.push_back(std::move(line));
      return;
    }
    // A closed line that was cut goes on over its own start.
    if (line.curve.closed && runs_.size() > 1 && runs_.front().from_start && inside_) {
      auto& last = runs_.back().conics;
      last.insert(last.end(), runs_.front().conics.begin(), runs_.front().conics.end());
      runs_.front() = std::move(runs_.back());
      runs_.pop_back();
    }
    for (const Run& run : runs_) {
      ConicLine part{line.level, {}};
      const auto lift = [](Vec2 p) { return Vec3{p.x, p.y, 0}; };
      for (const Conic& c : run.conics)
        part.curve.append(std::array{lift(c.points[0]), lift(c.points[1]), lift(c.points[2])}, 1,
                          std::array{1.0, c.weight, 1.0});
      if (!part.curve.empty()) out.push_back(std::move(part));
    }
  }

 private:
  /// Conics one after the other, all in cells with data.
  struct Run {
    bool from_start;
    std::vector<Conic> conics;
  };

  void add(const Conic& c) {
    passings_.clear();
    const auto [low_x, high_x] = std::minmax({c.points[0].x, c.points[1].x, c.points[2].x});
    const auto [low_y, high_y] = std::minmax({c.points[0].y, c.points[1].y, c.points[2].y});
    const Cell first = cell_of({low_x, high_y}, grid_), last = cell_of({high_x, low_y}, grid_);
    const auto pass = [&](bool vertical, double line) {
      const auto of = [&](std::size_t k) { return (vertical ? c.points[k].x : c.points[k].y) - line; };
      each_root(of(0), c.weight * of(1), of(2), [&](double t) { passings_.push_back({t, vertical, line}); });
    };
    for (int k = first.column; k < last.column; ++k) pass(true, corner_place({k, 0}, grid_).x);
    for (int k = first.row; k < last.row; ++k) pass(false, corner_place({0, k}, grid_).y);
    std::sort(passings_.begin(), passings_.end(), [](const Passing& a, const Passing& b) { return a.t < b.t; });
    double begin = 0;    // of what has not been given to a run
    double checked = 0;  // up to here the cells are known
    const Passing* at_begin = nullptr;
    for (std::size_t k = 0; k <= passings_.size(); ++k) {
      const double until = k < passings_.size() ? passings_[k].t : 1;
      if (until - checked <= kTouch && k < passings_.size()) continue;
      const Vec3 middle = polar(c, (checked + until) / 2, (checked + until) / 2);
      const bool data = holds_data(cell_of({middle.x / middle.z, middle.y / middle.z}, grid_), grid_);
      const bool start = !started();
      if (start || data != inside_) {
        const Passing* here = k > 0 ? &passings_[k - 1] : nullptr;
        if (!start) {
          give(c, begin, checked, at_begin, here);
          was_cut_ = true;
        }
        inside_ = data;
        if (data || start) runs_.push_back({start, {}});
        begin = checked;
        at_begin = here;
      }
      checked = until;
    }
    give(c, begin, 1, at_begin, nullptr);
  }
  bool started() const { return !runs_.empty(); }

  void give(const Conic& c, double from, double to, const Passing* at_from, const Passing* at_to) {
    if (!inside_ || to - from <= kTouch) return;
    Conic part = part_of(c, from, to);
    const auto snap = [](Vec2& p, const Passing* at) {
      if (at != nullptr) (at->vertical ? p.x : p.y) = at->line;
    };
    snap(part.points[0], at_from);
    snap(part.points[2], at_to);
    runs_.back().conics.push_back(part);
  }

  const GridDomain& grid_;
  bool was_cut_ = false, inside_ = false;
  std::vector<Run> runs_;
  std::vector<Passing> passings_;
};

}  // namespace

std::vector<ConicLine> cut_conics(std::vector<ConicLine> lines, const GridDomain& grid, const Context& context) {
  std::vector<ConicLine> parts;
  Cutter cutter(grid);
  for (ConicLine& line : lines) {
    context.check();
    cutter.cut(std::move(line), parts);
  }
  return parts;
}

}  // namespace retalho
