#include "retalho/tetraquad/fit_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/core/memory.h"
#include "retalho/tetraquad/growth.h"
#include "retalho/tetraquad/local_fit.h"

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
  if (!(options.cg_tolerance > 0 && options.cg_tolerance < 1))
    throw UsageError("the tolerance of conjugate gradients lies between 0 and 1", {}, "--fit");
}

void check_need(std::size_t vertices, std::size_t points, const TetraQuadFitOptions& options, const std::string& how) {
  const auto n = static_cast<double>(vertices);
  const double a_vertex = options.solver == TetraQuadSolver::local ? 5000
                          : options.solver == TetraQuadSolver::cg  ? 9500
                                                                   : 20000 + 5500 * std::log2(std::max(n, 2.0));
  check_memory(kProcessMemory + a_vertex * n + 200 * static_cast<double>(points),
               fmt::format("a fit of {} vertices ({})", vertices, how), {});
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
  if (cloud.positions.size() >= (std::size_t{1} << 32) - 1) throw BadInput("more than 4 billion points");
  if (report.used == 0) throw BadInput("there is no point with finite coordinates to make a surface of");
  const Vec3 size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  const double reach = std::max(
      {std::abs(low.x), std::abs(low.y), std::abs(low.z), std::abs(high.x), std::abs(high.y), std::abs(high.z)});
  if (!(longest > 1e-12 * reach))
    throw BadInput(fmt::format("all {} points lie at one place: that makes no surface", report.used));
  if (longest > 1e150) throw BadInput("coordinates beyond 1e150: scale them");
  const double step = longest / options.resolution * 1.0000001;
  // Off the points' own lattice, so that a box's faces do not run along faces of the grid.
  const Vec3 middle = 0.5 * (low + high);
  const auto cells = [&](double length) { return std::ceil(length / step - 1e-6); };
  const Vec3 origin =
      middle - step * Vec3{0.5 * cells(size.x) - 1e-4, 0.5 * cells(size.y) - 2e-4, 0.5 * cells(size.z) - 3e-4};
  std::vector<std::uint32_t> kept;
  if (report.used < report.points) kept.reserve(report.used);
  for (std::size_t k = 0; k < cloud.positions.size(); ++k) {
    if (!is_finite(cloud.positions[k])) continue;
    if (report.used < report.points) kept.push_back(static_cast<std::uint32_t>(k));
    const double length = has_normals && is_finite(cloud.normals[k]) ? norm(cloud.normals[k]) : 0;
    if (!(length > 1e-100 && std::isfinite(length))) ++report.without_normal;
  }
  if (report.without_normal == report.used)
    throw BadInput("the points have no normals: estimate them first (estimate_normals, retalho reconstruct does)");
  if (report.points > report.used)
    report.warnings.push_back(
        fmt::format("{} points without finite coordinates were left out", report.points - report.used));
  if (report.without_normal > 0)
    report.warnings.push_back(
        fmt::format("{} points have no usable normal: only their places count", report.without_normal));
  return {cloud, std::move(kept), origin, step};
}

void solve_surface(TetraQuad& surface, const HalfFaces& faces, const SampleRuns& runs, const SampleBins* bins,
                   const TetraQuad* before, const EnergyWeights& weights, const TetraQuadFitOptions& options,
                   TetraQuadFitReport& report, const Context& context) {
  if (options.solver == TetraQuadSolver::cholesky)
    return solve_energy(assemble_energy(surface.mesh, faces, runs, weights, context), surface.quadrics,
                        &report.factor_numbers, context);
  surface.quadrics.assign(surface.mesh.lattice.size(), Quadric{});
  std::vector<char> left(surface.mesh.lattice.size(), 1);
  if (options.solver == TetraQuadSolver::cg && before != nullptr)
    left = start_from(*before, surface.mesh, surface.quadrics);
  fit_locally(*bins, surface.mesh, left, vertex_sizes(surface.mesh), surface.quadrics, context);
  if (options.solver == TetraQuadSolver::local) return;
  const CgNotes notes = solve_energy_by_cg(assemble_energy(surface.mesh, faces, runs, weights, context),
                                           surface.quadrics, options.cg_tolerance, context);
  report.iterations += notes.iterations;
  if (notes.residual > options.cg_tolerance)
    report.warnings.push_back(fmt::format("conjugate gradients stopped after {} iterations at {:.2g}, not {:.2g}",
                                          notes.iterations, notes.residual, options.cg_tolerance));
}

void solve_added(TetraQuad& surface, const HalfFaces& faces, const std::vector<char>& is_new, const SampleBins* bins,
                 const ClosedGuide* guide, const EnergyWeights& weights, const TetraQuadFitOptions& options,
                 const Context& context) {
  if (guide != nullptr)
    guide->fill(surface, is_new);
  else if (options.solver == TetraQuadSolver::local)
    fit_locally(*bins, surface.mesh, is_new, vertex_sizes(surface.mesh), surface.quadrics, context);
  else
    solve_new(surface, faces, is_new, weights, context);
}

void count_sizes(const TetraQuadField& field, TetraQuadFitReport& report) {
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
}

void measure(const TetraQuadField& field, const SampleRuns& runs, const TetraQuadErrorOptions& error,
             TetraQuadFitReport& report) {
  count_sizes(field, report);
  std::vector<double> residuals;
  residuals.reserve(runs.size());
  double sum = 0;
  for (std::size_t t = 0; t < runs.tets(); ++t)
    for (const std::uint32_t k : runs.in(t)) {
      const Jet3 jet = field.gradient(t, field.frame(t).barycentric(runs.samples().place(k)));
      const double slope = norm(jet.gradient);
      residuals.push_back(std::abs(jet.value) / std::max(slope, 1e-12));
      sum += residuals.back();
    }
  report.residual_mean = sum / static_cast<double>(residuals.size());
  report.residual_max = *std::max_element(residuals.begin(), residuals.end());
  const auto last = static_cast<double>(residuals.size());
  const auto rank =
      residuals.begin() + static_cast<std::ptrdiff_t>(std::max(1.0, std::ceil(error.quantile * last))) - 1;
  std::nth_element(residuals.begin(), rank, residuals.end());
  report.residual_quantile = *rank;
  if (error.max_error > 0)
    report.outliers = static_cast<std::size_t>(
        std::count_if(residuals.begin(), residuals.end(), [&](double r) { return r > error.max_error; }));
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
