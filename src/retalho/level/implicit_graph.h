// The exact graph of a formula that is a polynomial in x.
#pragma once

#include <optional>

#include "retalho/curve/curve.h"
#include "retalho/level/implicit_tensor.h"

namespace retalho {

/// (x, f(x)) on [from, to] as one Bézier segment where f is a polynomial in x of degree 30 at most.
std::optional<Curve> polynomial_graph(const Expression& f, double from, double to);

}  // namespace retalho
