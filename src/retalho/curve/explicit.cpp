#include "retalho/curve/explicit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"

namespace retalho {

namespace {

constexpr int kDeepest = 31;      // gaps are narrower than 2^-31 of the interval
constexpr int kFlatDeepest = 14;  // where f is continuous but wild, stop refining here
constexpr std::size_t kMostEvaluations = 2'000'000;

class Tracing {
 public:
  Tracing(const Expression& f, const ExplicitOptions& options, double width, ExplicitCurve& out, const Context& context)
      : f_(f), out_(out), context_(context), x_scale_(width), tolerance_(options.tolerance) {}

  void run(double from, double to) {
    const Vec2 a = at(from), b = at(to);
    visit(a, b, 0);
    end_line();
  }

 private:
  Vec2 at(double x) {
    if ((++out_.evaluations & 1023U) == 0) context_.check();
    return {x, f_(x)};
  }

  void visit(Vec2 a, Vec2 b, int level) {
    const IntervalJet jet = f_.enclose({a.x, b.x}, {0, 0});
    ++out_.evaluations;
    if (!jet.possible) return gap(a, b);
    const double height = out_.high - out_.low;
    // Far outside of the window a straight piece will do, if it is one piece at all.
    const bool outside = jet.value.low > out_.high + height || jet.value.high < out_.low - height;
    if (jet.defined && std::isfinite(a.y) && std::isfinite(b.y)) {
      if (outside || level >= kFlatDeepest || flat(a, b, level)) return join(a, b);
    } else if (level >= kDeepest || out_.evaluations > kMostEvaluations || (outside && level >= 12)) {
      return gap(a, b);
    }
    const Vec2 middle = at(0.5 * (a.x + b.x));
    visit(a, middle, level + 1);
    visit(middle, b, level + 1);
  }

  /// Off-centre probes, so that a wave with a zero in the middle is not taken for a line.
  bool flat(Vec2 a, Vec2 b, int level) {
    if (level < 5) return false;
    const double height = out_.high - out_.low;
    for (const double t : {0.5, 0.25, 0.618}) {
      const Vec2 p = at(a.x + t * (b.x - a.x));
      const double dx = (b.x - a.x) / x_scale_, dy = (b.y - a.y) / height,
                   off = (p.y - (a.y + t * (b.y - a.y))) / height;
      // Distance from the chord in the window's unit square.
      if (!(std::abs(off) * dx <= tolerance_ * std::hypot(dx, dy))) return false;
    }
    return true;
  }

  void join(Vec2 a, Vec2 b) {
    if (line_.empty()) {
      if (gap_open_ && !out_.lines.empty()) out_.breaks.push_back(0.5 * (out_.lines.back().back().x + a.x));
      line_.push_back(a);
    }
    gap_open_ = false;
    line_.push_back(b);
  }
  void gap(Vec2, Vec2) {
    end_line();
    gap_open_ = true;
  }
  void end_line() {
    if (line_.size() > 1) out_.lines.push_back(std::move(line_));
    line_.clear();
  }

  const Expression& f_;
  ExplicitCurve& out_;
  const Context& context_;
  double x_scale_, tolerance_;
  std::vector<Vec2> line_;
  bool gap_open_ = false;
};

/// Between the 5th and the 95th percentile, and as much again on both sides, but no more than there is.
void choose_window(const Expression& f, double from, double to, ExplicitCurve& out) {
  std::vector<double> y;
  constexpr int kSamples = 1001;
  for (int i = 0; i < kSamples; ++i) {
    // Slightly uneven, so that a pole in the middle of a symmetric interval is not hit exactly.
    const double v = f(from + (to - from) * (i + 0.01) / (kSamples - 0.98));
    if (std::isfinite(v)) y.push_back(v);
  }
  out.evaluations += kSamples;
  if (y.empty()) {
    out.low = -1, out.high = 1;
    return;
  }
  std::sort(y.begin(), y.end());
  const double p05 = y[y.size() / 20], p95 = y[y.size() - 1 - y.size() / 20], spread = p95 - p05;
  out.low = std::max(y.front(), p05 - spread);
  out.high = std::min(y.back(), p95 + spread);
  if (!(out.high - out.low > 1e-12 * (std::abs(out.low) + std::abs(out.high)))) out.low -= 1, out.high += 1;
}

}  // namespace

ExplicitCurve trace_explicit(const Expression& f, double from, double to, const ExplicitOptions& options,
                             const Context& context) {
  if (!(from < to) || !std::isfinite(to - from))
    throw UsageError(fmt::format("the interval from {} to {} is empty", from, to));
  if (f.uses_y())
    throw BadInput(fmt::format(
        "formula \"{}\": an explicit curve is a function of x alone; use kind \"implicit\" for f(x, y) = 0", f.text()));
  ExplicitCurve out;
  out.low = options.low;
  out.high = options.high;
  if (!(options.low < options.high)) choose_window(f, from, to, out);
  Tracing(f, options, to - from, out, context).run(from, to);
  if (out.lines.empty())
    throw BadInput(fmt::format("formula \"{}\" is defined nowhere between {} and {}", f.text(), from, to));
  return out;
}

}  // namespace retalho
