// Bernstein-Bézier polynomials on a triangle against polynomials written out in x and y.
#include "retalho/bernstein/triangle.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <random>

namespace retalho {
namespace {

/// Coefficients of x^a y^b, a + b <= 3, with values and derivatives.
struct Polynomial {
  double c[4][4] = {};
  double derivative(Vec2 p, int in_x, int in_y) const {
    const auto falling = [](int n, int k) {
      double f = 1;
      for (int m = 0; m < k; ++m) f *= n - m;
      return f;
    };
    double sum = 0;
    for (int a = in_x; a <= 3; ++a)
      for (int b = in_y; a + b <= 3; ++b)
        sum += c[a][b] * falling(a, in_x) * falling(b, in_y) * std::pow(p.x, a - in_x) * std::pow(p.y, b - in_y);
    return sum;
  }
};

/// Ordinates of `f`, of total degree at most Degree, on a triangle: found from its values at the domain points.
template <int Degree>
TriangleNet<Degree> net_of(const Polynomial& f, Vec2 a, Vec2 b, Vec2 c) {
  constexpr std::size_t n = ordinate_count(Degree);
  double m[n][n + 1];
  std::size_t row = 0;
  for (int i = Degree; i >= 0; --i)
    for (int j = Degree - i; j >= 0; --j, ++row) {
      const Barycentric u{1.0 * i / Degree, 1.0 * j / Degree, 1.0 * (Degree - i - j) / Degree};
      for (std::size_t k = 0; k < n; ++k) {
        TriangleNet<Degree> one{};
        one[k] = 1;
        m[row][k] = evaluate<Degree>(one, u);
      }
      m[row][n] = f.derivative(u.r * a + u.s * b + u.t * c, 0, 0);
    }
  for (std::size_t p = 0; p < n; ++p) {
    std::size_t best = p;
    for (std::size_t r = p + 1; r < n; ++r)
      if (std::abs(m[r][p]) > std::abs(m[best][p])) best = r;
    for (std::size_t k = 0; k <= n; ++k) std::swap(m[p][k], m[best][k]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == p) continue;
      const double f_row = m[r][p] / m[p][p];
      for (std::size_t k = p; k <= n; ++k) m[r][k] -= f_row * m[p][k];
    }
  }
  TriangleNet<Degree> net{};
  for (std::size_t k = 0; k < n; ++k) net[k] = m[k][n] / m[k][k];
  return net;
}

template <int Degree>
void check_jets() {
  const bool held =
      rc::check("value, gradient and second derivatives; the net bounds the values", [](std::uint64_t seed) {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> unit(-1, 1);
        Polynomial f;
        for (int a = 0; a <= Degree; ++a)
          for (int b = 0; a + b <= Degree; ++b) f.c[a][b] = unit(random);
        const Vec2 a{unit(random), unit(random)};
        const double turn = 3.2 * unit(random);
        const auto at = [&](double angle, double length) {
          return a + length * Vec2{std::cos(angle), std::sin(angle)};
        };
        const Vec2 b = at(turn, 1.5 + unit(random)), c = at(turn + 1.2 + unit(random), 1.5 + unit(random));
        const TriangleNet<Degree> net = net_of<Degree>(f, a, b, c);
        const TriangleFrame frame(a, b, c);
        const auto [low, high] = bounds<Degree>(net);
        for (int k = 0; k < 5; ++k) {
          Barycentric u{std::abs(unit(random)), std::abs(unit(random)), std::abs(unit(random))};
          const double sum = u.r + u.s + u.t;
          u = {u.r / sum, u.s / sum, u.t / sum};
          const Vec2 p = u.r * a + u.s * b + u.t * c;
          const Barycentric again = frame.barycentric(p);
          RC_ASSERT(std::abs(again.r - u.r) + std::abs(again.s - u.s) + std::abs(again.t - u.t) < 1e-12);
          const Jet jet = evaluate_jet<Degree>(net, frame, u);
          const double tolerance = 1e-9;
          RC_ASSERT(std::abs(jet.value - f.derivative(p, 0, 0)) < tolerance);
          RC_ASSERT(std::abs(evaluate<Degree>(net, u) - jet.value) < tolerance);
          RC_ASSERT(std::abs(jet.gradient.x - f.derivative(p, 1, 0)) < tolerance);
          RC_ASSERT(std::abs(jet.gradient.y - f.derivative(p, 0, 1)) < tolerance);
          RC_ASSERT(std::abs(jet.xx - f.derivative(p, 2, 0)) < 100 * tolerance);
          RC_ASSERT(std::abs(jet.xy - f.derivative(p, 1, 1)) < 100 * tolerance);
          RC_ASSERT(std::abs(jet.yy - f.derivative(p, 0, 2)) < 100 * tolerance);
          RC_ASSERT(jet.value > low - tolerance && jet.value < high + tolerance);
        }
      });
  EXPECT_TRUE(held);
}

TEST(Triangle, JetsAreThoseOfThePolynomial) {
  check_jets<1>();
  check_jets<2>();
  check_jets<3>();
}

TEST(Triangle, OrdinatesStandInDescendingOrder) {
  int at = 0;
  for (int i = 3; i >= 0; --i)
    for (int j = 3 - i; j >= 0; --j) EXPECT_EQ(ordinate_index(3, i, j), at++);
  EXPECT_EQ(at, ordinate_count(3));
}

}  // namespace
}  // namespace retalho
