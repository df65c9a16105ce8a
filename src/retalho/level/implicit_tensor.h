// A polynomial in x and y on a box, as tensor-product Bernstein coefficients with a bound for their rounding error.
// Made from a formula by doing its own additions and multiplications on coefficients: no power basis in between, so
// nothing cancels that does not cancel in the formula.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "retalho/curve/expression.h"

namespace retalho {

struct TensorBernstein {
  int degree_x = 0, degree_y = 0;
  std::vector<double> c;  ///< c[i * (degree_y + 1) + j]: i along x, j along y
  double error = 0;       ///< every coefficient is within this of the exact one

  double at(int i, int j) const { return c[static_cast<std::size_t>(i * (degree_y + 1) + j)]; }
};

struct PlaneBox {
  double x0 = 0, y0 = 0, x1 = 1, y1 = 1;
};

/// f on the box, where f is a polynomial of degree 30 at most in each variable (+ - * , whole powers, division by
/// constants, constants of any form); nothing otherwise.
std::optional<TensorBernstein> polynomial_on_box(const Expression& f, const PlaneBox& box);

/// Value at (u, v) in [0, 1]^2.
double evaluate(const TensorBernstein& p, double u, double v);

}  // namespace retalho
