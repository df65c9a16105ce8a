// The tree on intervals, with its gradient (forward differentiation), for proofs that a box holds no zero.
#include <cmath>
#include <numbers>

#include "retalho/curve/expression.h"

namespace retalho {

namespace {

using Op = Expression::Op;

IntervalJet constant(double v) {
  return {{v, v}, {0, 0}, {0, 0}};
}

IntervalJet undefined_everywhere() {
  IntervalJet j{whole_line(), whole_line(), whole_line()};
  j.defined = j.possible = j.smooth = false;
  return j;
}

/// Chain rule: f(a) with value range `value` and derivative range `slope`.
IntervalJet chain(const IntervalJet& a, Interval value, Interval slope) {
  IntervalJet j = a;
  j.value = value;
  j.dx = slope * a.dx;
  j.dy = slope * a.dy;
  return j;
}

template <typename Function>
Interval rising(Interval a, Function f) {
  return widened_function(f(a.low), f(a.high));
}

/// Range of cos on [low, high].
Interval cosine(Interval a) {
  if (!std::isfinite(a.low) || !std::isfinite(a.high) || a.high - a.low >= 2 * std::numbers::pi ||
      std::abs(a.low) > 1e8)
    return {-1, 1};
  const Interval ends =
      widened_function(std::min(std::cos(a.low), std::cos(a.high)), std::max(std::cos(a.low), std::cos(a.high)));
  double low = ends.low, high = ends.high;
  // Extrema at multiples of pi; a margin for their rounding only widens the range.
  const double margin = 1e-15 * (1 + std::abs(a.low) + std::abs(a.high));
  for (double k = std::ceil((a.low - margin) / std::numbers::pi); k * std::numbers::pi <= a.high + margin; ++k)
    (std::fmod(std::abs(k), 2.0) == 0 ? high : low) = std::fmod(std::abs(k), 2.0) == 0 ? 1 : -1;
  return {std::max(low, -1.0), std::min(high, 1.0)};
}

Interval sine(Interval a) {
  const double quarter = std::numbers::pi / 2;
  return cosine(widened(std::nextafter(a.low - quarter, -kInfinity), std::nextafter(a.high - quarter, kInfinity)));
}

/// Cuts the argument to where the function exists: [low, high].
bool restrict_domain(IntervalJet& a, double low, double high) {
  if (a.value.high < low || a.value.low > high) return false;
  if (a.value.low < low || a.value.high > high) a.defined = a.smooth = false;
  a.value = {std::max(a.value.low, low), std::min(a.value.high, high)};
  return true;
}

IntervalJet whole_power(const IntervalJet& a, int n);

IntervalJet reciprocal(const IntervalJet& a) {
  if (a.value.low == 0 && a.value.high == 0) return undefined_everywhere();
  IntervalJet j = a;
  if (a.value.contains_zero()) j.defined = j.smooth = false;
  j.value = Interval{1, 1} / a.value;
  const Interval slope = -(Interval{1, 1} / square(a.value));
  j.dx = slope * a.dx;
  j.dy = slope * a.dy;
  return j;
}

IntervalJet multiply(const IntervalJet& a, const IntervalJet& b) {
  return {a.value * b.value,      a.dx * b.value + a.value * b.dx, a.dy * b.value + a.value * b.dy,
          a.defined && b.defined, a.possible && b.possible,        a.smooth && b.smooth};
}

IntervalJet whole_power(const IntervalJet& a, int n) {
  if (n == 0) return chain(a, {1, 1}, {0, 0});
  if (n < 0) return reciprocal(whole_power(a, -n));
  return chain(a, power(a.value, n), Interval{static_cast<double>(n), static_cast<double>(n)} * power(a.value, n - 1));
}

IntervalJet natural_log(IntervalJet a) {
  if (a.value.high <= 0) return undefined_everywhere();
  if (a.value.low <= 0) a.defined = a.smooth = false;
  const double low = std::max(a.value.low, 0.0);
  const Interval value = widened_function(low == 0 ? -kInfinity : std::log(low), std::log(a.value.high));
  return chain(a, value, Interval{1, 1} / Interval{low, a.value.high});
}

IntervalJet exponential(const IntervalJet& a) {
  Interval v = rising(a.value, [](double t) { return std::exp(t); });
  v.low = std::max(0.0, v.low);
  return chain(a, v, v);
}

IntervalJet enclose_function(Op op, IntervalJet a) {
  const Interval one{1, 1};
  switch (op) {
    case Op::negate:
      return {-a.value, -a.dx, -a.dy, a.defined, a.possible, a.smooth};
    case Op::sqrt: {
      if (!restrict_domain(a, 0, kInfinity)) return undefined_everywhere();
      Interval v = rising(a.value, [](double t) { return std::sqrt(t); });
      v.low = std::max(0.0, v.low);
      if (a.value.low == 0) a.smooth = false;
      return chain(a, v, one / (Interval{2, 2} * v));
    }
    case Op::cbrt: {
      const Interval v = rising(a.value, [](double t) { return std::cbrt(t); });
      if (a.value.contains_zero()) a.smooth = false;
      return chain(a, v, one / (Interval{3, 3} * square(v)));
    }
    case Op::abs: {
      if (a.value.low >= 0) return a;
      if (a.value.high <= 0) return enclose_function(Op::negate, a);
      IntervalJet j = chain(a, {0, std::max(-a.value.low, a.value.high)}, {-1, 1});
      j.smooth = false;
      return j;
    }
    case Op::exp:
      return exponential(a);
    case Op::log:
      return natural_log(a);
    case Op::log10: {
      const IntervalJet l = natural_log(a);
      const double f = 1 / std::numbers::ln10;
      return multiply(l, {widened(f, f), {0, 0}, {0, 0}});
    }
    case Op::sin:
      return chain(a, sine(a.value), cosine(a.value));
    case Op::cos:
      return chain(a, cosine(a.value), -sine(a.value));
    case Op::tan: {
      const IntervalJet s = enclose_function(Op::sin, a), c = enclose_function(Op::cos, a);
      // Inside one branch the tangent rises; across a pole nothing is known.
      if (c.value.contains_zero()) return multiply(s, reciprocal(c));
      const Interval v = rising(a.value, [](double t) { return std::tan(t); });
      return chain(a, v, one + square(v));
    }
    case Op::asin:
    case Op::acos: {
      if (!restrict_domain(a, -1, 1)) return undefined_everywhere();
      if (a.value.low == -1 || a.value.high == 1) a.smooth = false;
      const Interval slope = one / enclose_function(Op::sqrt, {one - square(a.value), {}, {}}).value;
      if (op == Op::asin) return chain(a, rising(a.value, [](double t) { return std::asin(t); }), slope);
      return chain(a, widened_function(std::acos(a.value.high), std::acos(a.value.low)), -slope);
    }
    case Op::atan:
      return chain(a, rising(a.value, [](double t) { return std::atan(t); }), one / (one + square(a.value)));
    case Op::sinh: {
      const Interval magnitude = enclose_function(Op::abs, a).value;
      return chain(a, rising(a.value, [](double t) { return std::sinh(t); }),
                   rising(magnitude, [](double t) { return std::cosh(t); }));
    }
    case Op::cosh: {
      const Interval magnitude = enclose_function(Op::abs, a).value;
      return chain(a, rising(magnitude, [](double t) { return std::cosh(t); }),
                   rising(a.value, [](double t) { return std::sinh(t); }));
    }
    case Op::tanh: {
      const Interval v = rising(a.value, [](double t) { return std::tanh(t); });
      return chain(a, v, one - square(v));
    }
    case Op::floor: {
      IntervalJet j{
          {std::floor(a.value.low), std::floor(a.value.high)}, {0, 0}, {0, 0}, a.defined, a.possible, a.smooth};
      if (j.value.low != j.value.high) j.smooth = j.defined = false;
      return j;
    }
    case Op::sign: {
      const auto s = [](double v) { return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0; };
      IntervalJet j{{s(a.value.low), s(a.value.high)}, {0, 0}, {0, 0}, a.defined, a.possible, a.smooth};
      if (j.value.low != j.value.high) j.smooth = j.defined = false;
      return j;
    }
    default:
      break;
  }
  return undefined_everywhere();
}

IntervalJet general_power(const IntervalJet& a, const IntervalJet& b) {
  if (b.value.low == b.value.high) {
    const double n = b.value.low;
    if (n == std::floor(n) && std::abs(n) <= 512) return whole_power(a, static_cast<int>(n));
  }
  // pow of a negative base exists for whole exponents only: elsewhere a^b = exp(b log a).
  IntervalJet j = exponential(multiply(b, natural_log(a)));
  if (a.value.low <= 0 && !(b.value.low == b.value.high)) {  // whole exponents may occur inside
    j = {whole_line(), whole_line(), whole_line(), false, true, false};
  } else if (a.value.contains_zero() && b.value.low > 0) {
    j.value.low = 0;
  }
  return j;
}

IntervalJet least(const IntervalJet& a, const IntervalJet& b, bool most) {
  const auto pick = [most](double p, double q) { return most ? std::max(p, q) : std::min(p, q); };
  IntervalJet j{{pick(a.value.low, b.value.low), pick(a.value.high, b.value.high)},
                join(a.dx, b.dx),
                join(a.dy, b.dy),
                a.defined && b.defined,
                a.possible && b.possible,
                a.smooth && b.smooth};
  if (a.value.high >= b.value.low && b.value.high >= a.value.low) j.smooth = false;
  return j;
}

}  // namespace

IntervalJet Expression::enclose(Interval x, Interval y) const {
  constexpr std::size_t kSmall = 64;
  IntervalJet stack[kSmall];
  std::vector<IntervalJet> heap(nodes_.size() > kSmall ? nodes_.size() : 0);
  IntervalJet* v = heap.empty() ? stack : heap.data();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& n = nodes_[i];
    const IntervalJet a = n.a >= 0 ? v[n.a] : IntervalJet{}, b = n.b >= 0 ? v[n.b] : IntervalJet{};
    const bool defined = a.defined && b.defined, possible = a.possible && b.possible, smooth = a.smooth && b.smooth;
    switch (n.op) {
      case Op::number:
        v[i] = constant(n.number);
        break;
      case Op::x:
        v[i] = {x, {1, 1}, {0, 0}};
        break;
      case Op::y:
        v[i] = {y, {0, 0}, {1, 1}};
        break;
      case Op::add:
        v[i] = {a.value + b.value, a.dx + b.dx, a.dy + b.dy, defined, possible, smooth};
        break;
      case Op::subtract:
        v[i] = {a.value - b.value, a.dx - b.dx, a.dy - b.dy, defined, possible, smooth};
        break;
      case Op::multiply:
        v[i] = n.a == n.b ? whole_power(a, 2) : multiply(a, b);
        break;
      case Op::divide:
        v[i] = multiply(a, reciprocal(b));
        break;
      case Op::power:
        v[i] = general_power(a, b);
        break;
      case Op::min:
        v[i] = least(a, b, false);
        break;
      case Op::max:
        v[i] = least(a, b, true);
        break;
      default:
        v[i] = enclose_function(n.op, a);
    }
    // What was undefined somewhere below stays so: operators only add to it.
    v[i].defined = v[i].defined && defined;
    v[i].possible = v[i].possible && possible;
    v[i].smooth = v[i].smooth && smooth;
  }
  return v[nodes_.size() - 1];
}

}  // namespace retalho
