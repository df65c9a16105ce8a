// The graph y = f(x) as polylines: joined only where f is proved to be continuous (intervals), so that poles, jumps and
// holes of the domain are never drawn over (docs/curves.md, "Explicit curves").
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/curve/expression.h"

namespace retalho {

struct ExplicitOptions {
  /// Largest distance of a probe from its chord, as a part of the window's height and the interval's width.
  double tolerance = 5e-4;
  /// What is looked at closely in y; low >= high: chosen from samples, so that poles do not flatten everything else.
  double low = 0, high = 0;
};

struct ExplicitCurve {
  std::vector<std::vector<Vec2>> lines;  ///< ascending in x; between two lines f was not proved to be continuous
  std::vector<double> breaks;  ///< middles of the gaps inside of the interval: poles, jumps, ends of the domain
  double low = 0, high = 1;    ///< the window in y
  std::size_t evaluations = 0;
};

/// Promise: along every line f is continuous, and each vertex is (x, f(x)). Throws UsageError unless from < to, and
/// BadInput when f uses y or is nowhere defined on the interval. Gaps are narrower than 1e-9 of the interval.
ExplicitCurve trace_explicit(const Expression& f, double from, double to, const ExplicitOptions& options = {},
                             const Context& context = {});

}  // namespace retalho
