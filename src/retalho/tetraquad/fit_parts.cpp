#include "retalho/tetraquad/fit_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"

namespace retalho {
namespace {

bool is_finite(Vec3 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

void check_options(const TetraQuadFitOptions& options) {
  if (options.resolution < 2 || options.resolution > 1000)
    throw UsageError("the resolution must be from 2 to 1000 cubes along the longest side", {}, "--resolution");
  const bool weights = options.smoothness > 0 && options.bending >= 0 && options.normal_weight > 0 &&
                       options.ridge >= 0 && *std::min_element(options.jump.begin(), options.jump.end()) >= 0;
  if (!weights || !std::isfinite(options.smoothness))
    throw UsageError("the weights of the fit must be positive numbers", {}, "--smoothness");
}

Samples take_samples(const PointCloud& cloud, const TetraQuadFitOptions& options, TetraQuadFitReport& report) {
  const bool has_normals = cloud.normals.size() == cloud.positions.size();
  report.points = cloud.positions.size();
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  for (const Vec3& p : cloud.positions) {
    if (!is_finite(p)) continue;
    ++report.used;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  if (report.used == 0) throw BadInput("there is no point with finite coordinates to make a surface of");
  const Vec3 size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  const double reach = std::max(
      {std::abs(low.x), std::abs(low.y), std::abs(low.z), std::abs(high.x), std::abs(high.y), std::abs(high.z)});
  if (!(longest > 1e-12 * reach))
    throw BadInput(fmt::format("all {} points lie at one place: that makes no surface", report.used));
  if (longest > 1e150) throw BadInput("coordinates beyond 1e150: scale them");
  Samples out;
  out.step = longest / options.resolution * 1.0000001;
  // Off the points' own lattice, so that a box's faces do not run along faces of the grid.
  const Vec3 middle = 0.5 * (low + high);
  const auto cells = [&](double length) { return std::ceil(length / out.step - 1e-6); };
  out.origin =
      middle - out.step * Vec3{0.5 * cells(size.x) - 1e-4, 0.5 * cells(size.y) - 2e-4, 0.5 * cells(size.z) - 3e-4};
  for (std::size_t k = 0; k < cloud.positions.size(); ++k) {
    if (!is_finite(cloud.positions[k])) continue;
    Sample sample;
    sample.place = (cloud.positions[k] - out.origin) / out.step;
    if (has_normals && is_finite(cloud.normals[k])) {
      const double length = norm(cloud.normals[k]);
      if (length > 1e-100 && std::isfinite(length)) sample.normal = cloud.normals[k] / length;
    }
    if (norm2(sample.normal) == 0) ++report.without_normal;
    out.places.push_back(place_of(options.split, sample.place));
    out.samples.push_back(sample);
  }
  if (report.without_normal == report.used)
    throw BadInput("the points have no normals: estimate them first (estimate_normals, retalho reconstruct does)");
  if (report.points > report.used)
    report.warnings.push_back(
        fmt::format("{} points without finite coordinates were left out", report.points - report.used));
  if (report.without_normal > 0)
    report.warnings.push_back(
        fmt::format("{} points have no usable normal: only their places count", report.without_normal));
  return out;
}

void measure(const TetraQuadField& field, const std::vector<Sample>& samples, const TetraQuadErrorOptions& error,
             TetraQuadFitReport& report) {
  const TetMesh& mesh = field.surface().mesh;
  report.vertices = mesh.lattice.size();
  report.tetrahedra = mesh.tets.size();
  std::vector<char> live(mesh.lattice.size(), 0);
  report.crossed = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (!field.crosses(t)) continue;
    ++report.crossed;
    for (const std::uint32_t v : mesh.tets[t]) live[v] = 1;
  }
  report.coefficients = 10 * static_cast<std::size_t>(std::count(live.begin(), live.end(), 1));
  std::vector<double> residuals;
  residuals.reserve(samples.size());
  double sum = 0;
  for (const Sample& sample : samples) {
    const Jet3 jet = field.gradient(sample.tet, field.frame(sample.tet).barycentric(sample.place));
    const double slope = norm(jet.gradient);
    residuals.push_back(std::abs(jet.value) / std::max(slope, 1e-12));
    sum += residuals.back();
  }
  std::sort(residuals.begin(), residuals.end());
  report.residual_mean = sum / static_cast<double>(residuals.size());
  report.residual_max = residuals.back();
  const auto last = static_cast<double>(residuals.size());
  report.residual_quantile = residuals[static_cast<std::size_t>(std::max(1.0, std::ceil(error.quantile * last))) - 1];
  if (error.max_error > 0)
    report.outliers = static_cast<std::size_t>(residuals.end() -
                                               std::upper_bound(residuals.begin(), residuals.end(), error.max_error));
}

EnergyWeights weights_of(const TetraQuadFitOptions& options, double area, std::size_t samples) {
  EnergyWeights weights;
  weights.point = area / static_cast<double>(samples);
  weights.normal = options.normal_weight;
  for (std::size_t m = 0; m < 3; ++m) weights.jump[m] = options.smoothness * options.jump[m];
  weights.bending = options.smoothness * options.bending;
  weights.ridge = options.ridge;
  return weights;
}

}  // namespace retalho
