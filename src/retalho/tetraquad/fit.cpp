#include "retalho/tetraquad/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>

#include "retalho/core/error.h"
#include "retalho/tetraquad/fit_parts.h"
#include "retalho/tetraquad/growth.h"

namespace retalho {
namespace {

constexpr int kReach = 2;  // cells that the surface may be continued beyond those with points

/// `band`: tetrahedra with points, ascending; these, and those of the cubes around that have three vertices of them.
std::vector<TetPlace> first_band(std::vector<TetPlace> band, TetSplit split) {
  std::unordered_set<std::uint64_t> vertices, seen;
  for (const TetPlace& place : band)
    for (const LatticePoint& corner : lattice_corners(split, place)) vertices.insert(cell_key(corner));
  const std::size_t own = band.size();
  for (std::size_t n = 0; n < own; ++n) {
    if (n > 0 && band[n].cell == band[n - 1].cell) continue;
    for (int side = 0; side < 27; ++side) {
      TetPlace place;
      place.cell = {band[n].cell[0] + side % 3 - 1, band[n].cell[1] + side / 3 % 3 - 1, band[n].cell[2] + side / 9 - 1};
      if (!seen.insert(cell_key(place.cell)).second) continue;
      for (int type = 0; type < tets_of_cube(split); ++type) {
        place.type = static_cast<std::uint8_t>(type);
        const auto corners = lattice_corners(split, place);
        const auto shared = std::count_if(corners.begin(), corners.end(), [&](const LatticePoint& corner) {
          return vertices.contains(cell_key(corner));
        });
        if (shared >= 3) band.push_back(place);
      }
    }
  }
  return band;
}

TetraQuad fit(const PointCloud& cloud, const TetraQuadFitOptions& options, const TetraQuadErrorOptions& error,
              const TetraQuad* before, const ClosedGuide* given, TetraQuadFitReport* report_out,
              const Context& context) {
  check_options(options);
  TetraQuadFitReport report;
  report.resolution = options.resolution;
  const Samples samples = take_samples(cloud, options, report);
  const std::vector<TetPlace> with_points = occupied_places(samples, options.split, context);
  std::vector<LatticePoint> data;
  for (const TetPlace& place : with_points)
    if (data.empty() || data.back() != place.cell) data.push_back(place.cell);

  const EnergyWeights weights = weights_of(options, static_cast<double>(data.size()), samples.size());
  std::optional<SampleBins> bins;
  if (options.solver != TetraQuadSolver::cholesky) bins.emplace(samples, 1);
  TetraQuad surface;
  surface.georef = cloud.georef;
  surface.mesh = make_tet_mesh(samples.origin, samples.step, options.split, first_band(with_points, options.split));
  check_need(surface.mesh.lattice.size(), samples.size(), options, fmt::format("resolution {}", options.resolution));
  HalfFaces faces(surface.mesh.tets, surface.mesh.lattice.size());
  solve_surface(surface, faces, SampleRuns(samples, surface.mesh, context), bins ? &*bins : nullptr, before, weights,
                options, report, context);

  report.stray = drop_stray(surface, faces, with_points);
  const ClosedGuide* guide = nullptr;
  const Fill fill = [&](TetraQuad& grown, const HalfFaces& its_faces, const std::vector<char>& is_new) {
    solve_added(grown, its_faces, is_new, bins ? &*bins : nullptr, guide, weights, options, context);
  };
  report.growth_rounds = grow(surface, faces, data, kReach, options.growth, fill, nullptr, context);
  std::optional<ClosedGuide> made;
  if (options.closed && !open_faces(surface, faces).empty()) {
    if (given == nullptr) made.emplace(make_guide(cloud, options, context));
    guide = made ? &*made : given;
    report.growth_rounds += grow(surface, faces, data, kReach, kClosingRounds, fill, guide, context);
  }
  report.stray += drop_stray(surface, faces, with_points);
  report.open_faces = open_faces(surface, faces).size();
  measure(TetraQuadField(surface), SampleRuns(samples, surface.mesh, context), error, report);
  if (report_out != nullptr) *report_out = std::move(report);
  return surface;
}

}  // namespace

TetraQuad fit_along(const PointCloud& cloud, const TetraQuadFitOptions& options, const ClosedGuide& guide,
                    const Context& context) {
  return fit(cloud, options, {}, nullptr, &guide, nullptr, context);
}

TetraQuad fit_tetraquad(const PointCloud& cloud, const TetraQuadFitOptions& options, TetraQuadFitReport* report,
                        const Context& context) {
  return fit(cloud, options, {}, nullptr, nullptr, report, context);
}

TetraQuad fit_tetraquad_to(const PointCloud& cloud, const TetraQuadErrorOptions& error,
                           const TetraQuadFitOptions& options, TetraQuadFitReport* report_out, const Context& context) {
  if (!(error.max_error > 0) || !std::isfinite(error.max_error))
    throw UsageError("--max-error must be above 0", {}, "--max-error");
  if (!(error.quantile > 0 && error.quantile <= 1))
    throw UsageError("the share of the points that must be within lies above 0 and at most at 1", {}, "--quantile");
  if (error.coarsest < 2 || error.finest < error.coarsest || error.finest > 1000)
    throw UsageError("resolutions go from 2 to 1000, the finest not below the coarsest", {}, "--resolution");
  TetraQuadFitOptions now = options;
  now.resolution = error.coarsest;
  TetraQuad surface;
  int iterations = 0;
  while (true) {
    TetraQuadFitReport report;
    TetraQuad finer = fit(cloud, now, error, surface.quadrics.empty() ? nullptr : &surface, nullptr, &report, context);
    surface = std::move(finer);
    iterations += report.iterations;
    report.iterations = iterations;
    const bool reached = report.residual_quantile <= error.max_error;
    if (reached || now.resolution >= error.finest) {
      if (!reached)
        report.warnings.push_back(
            fmt::format("{:.4g} is not reached at resolution {}: {:.4g} % of the points are within {:.4g}; a finer "
                        "--resolution may do, or the points are noisier than that",
                        error.max_error, now.resolution, 100 * error.quantile, report.residual_quantile));
      if (report_out != nullptr) *report_out = std::move(report);
      return surface;
    }
    now.resolution = std::min(error.finest, now.resolution + std::max(1, now.resolution / 2));
  }
}

}  // namespace retalho
