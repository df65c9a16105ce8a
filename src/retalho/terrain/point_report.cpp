#include "retalho/terrain/point_report.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/terrain/evaluate.h"

namespace retalho {
namespace {

/// Sorted by x, then y; one a place, with the mean height.
std::vector<Vec3> places_of(std::span<const Vec3> points) {
  std::vector<Vec3> sorted(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t end = i;
    double sum = 0;
    for (; end < sorted.size() && sorted[end].x == sorted[i].x && sorted[end].y == sorted[i].y; ++end)
      sum += sorted[end].z;
    sorted[kept++] = {sorted[i].x, sorted[i].y, sum / static_cast<double>(end - i)};
    i = end;
  }
  sorted.resize(kept);
  return sorted;
}

}  // namespace

ErrorReport assess_points(const Terrain& terrain, std::span<const Vec3> points, double tolerance,
                          const Context& context) {
  const std::vector<Vec3> places = places_of(points);
  std::vector<Vec2> at;
  at.reserve(places.size());
  for (const Vec3& p : places) at.push_back({p.x, p.y});
  std::vector<double> heights(places.size());
  TerrainEvaluator(terrain, context).values(at, heights, context);
  ErrorReport report;
  report.cells = report.valid_cells = places.size();
  double squares = 0;
  std::size_t covered = 0;
  report.max_error = -1;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double error = std::abs(heights[i] - places[i].z);
    if (std::isnan(error)) continue;
    ++covered;
    squares += error * error;
    if (tolerance > 0 && error > tolerance) ++report.violations;
    if (error <= report.max_error) continue;
    report.max_error = error;
    report.max_error_at = terrain.georef.to_crs(at[i]);
  }
  report.uncovered = places.size() - covered;
  if (covered == 0) throw BadInput("the model covers none of the points");
  report.rmse = std::sqrt(squares / static_cast<double>(covered));
  return report;
}

}  // namespace retalho
