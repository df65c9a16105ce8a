// How fine a triangulation is asked for: max_error, vertices and ratio of fit, fit_points, fit_compact and compare.
#pragma once

#include <cstddef>
#include <optional>

namespace retalho::python {

struct AskedBudget {
  std::optional<double> max_error, ratio;
  std::optional<long long> vertices;

  bool given() const { return max_error || ratio || vertices; }
};

struct Budget {
  double max_error = 0;
  std::size_t vertices = 0;
};
/// `cells`: of which ratio is a share; `range`: of the heights, a hundredth of which is the tolerance where nothing is
/// asked for. Throws UsageError.
Budget resolve(const AskedBudget& asked, std::size_t cells, double range);

}  // namespace retalho::python
