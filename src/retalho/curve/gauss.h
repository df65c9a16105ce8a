// Integrals by 8-point Gauss-Legendre on panels that are halved until two levels agree.
#pragma once

#include <array>
#include <cmath>

namespace retalho {

template <typename Function>
double gauss_panel(const Function& f, double a, double b) {
  constexpr std::array<double, 4> kNode = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                           0.9602898564975363};
  constexpr std::array<double, 4> kWeight = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                             0.1012285362903763};
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  double total = 0;
  for (std::size_t i = 0; i < 4; ++i) total += kWeight[i] * (f(middle - half * kNode[i]) + f(middle + half * kNode[i]));
  return half * total;
}

template <typename Function>
double integrate_below(const Function& f, double a, double b, double whole, double tolerance, int level) {
  const double middle = 0.5 * (a + b);
  const double left = gauss_panel(f, a, middle), right = gauss_panel(f, middle, b);
  const double change = std::abs(left + right - whole);
  // Below rounding's share nothing can be gained, and of what is not finite halves are no better: 2^24 of them.
  if (change <= tolerance + 1e-16 * (std::abs(left) + std::abs(right)) || !std::isfinite(change) || level >= 24)
    return left + right;
  return integrate_below(f, a, middle, left, tolerance / 2, level + 1) +
         integrate_below(f, middle, b, right, tolerance / 2, level + 1);
}

/// Integral of f over [a, b]; two levels agree to `tolerance` (absolute) at least.
template <typename Function>
double integrate(const Function& f, double a, double b, double tolerance) {
  return integrate_below(f, a, b, gauss_panel(f, a, b), tolerance, 0);
}

}  // namespace retalho
