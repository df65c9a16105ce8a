#include "budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"

namespace retalho::python {
namespace {

constexpr double kDefaultShare = 0.01;  // of the height range, as the program's
constexpr std::size_t kLeastVertices = 3;

}  // namespace

Budget resolve(const AskedBudget& asked, std::size_t cells, double range) {
  Budget budget;
  if (asked.vertices && asked.ratio)
    throw UsageError("vertices and ratio say the same in two ways: give one of them", {}, "ratio");
  if (asked.max_error && !(std::isfinite(*asked.max_error) && *asked.max_error >= 0))
    throw UsageError(fmt::format("max_error must be 0 or more, not {}", *asked.max_error), {}, "max_error");
  if (asked.vertices && *asked.vertices < static_cast<long long>(kLeastVertices))
    throw UsageError(fmt::format("vertices must be {} or more, not {}", kLeastVertices, *asked.vertices), {},
                     "vertices");
  if (asked.ratio && !(*asked.ratio > 0 && *asked.ratio <= 1))
    throw UsageError(fmt::format("ratio must be above 0 and at most 1, not {}", *asked.ratio), {}, "ratio");
  if (asked.max_error) budget.max_error = *asked.max_error;
  if (asked.vertices) budget.vertices = static_cast<std::size_t>(*asked.vertices);
  if (asked.ratio)
    budget.vertices =
        std::max(kLeastVertices, static_cast<std::size_t>(std::llround(*asked.ratio * static_cast<double>(cells))));
  if (!asked.given()) budget.max_error = kDefaultShare * range;
  return budget;
}

}  // namespace retalho::python
