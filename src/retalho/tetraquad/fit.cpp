#include "retalho/tetraquad/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "retalho/core/error.h"
#include "retalho/tetraquad/energy.h"
#include "retalho/tetraquad/growth.h"

namespace retalho {
namespace {

constexpr int kReach = 2;  // cells that the surface may be continued beyond those with points

bool is_finite(Vec3 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void check_options(const TetraQuadFitOptions& options) {
  if (options.resolution < 2 || options.resolution > 1000)
    throw UsageError("the resolution must be from 2 to 1000 cubes along the longest side", {}, "--resolution");
  const bool weights = options.smoothness > 0 && options.bending >= 0 && options.normal_weight > 0 &&
                       options.ridge >= 0 && *std::min_element(options.jump.begin(), options.jump.end()) >= 0;
  if (!weights || !std::isfinite(options.smoothness))
    throw UsageError("the weights of the fit must be positive numbers", {}, "--smoothness");
}

/// The points in lattice coordinates, with unit normals (or none).
struct Samples {
  Vec3 origin;
  double step = 1;
  std::vector<Sample> samples;   ///< tet is not set yet
  std::vector<TetPlace> places;  ///< of each
};

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

/// Tetrahedra with points, and those of the cubes around that have three vertices of them.
std::vector<TetPlace> first_band(const Samples& samples, TetSplit split, std::size_t& cells) {
  std::vector<TetPlace> band = samples.places;
  std::sort(band.begin(), band.end());
  band.erase(std::unique(band.begin(), band.end()), band.end());
  std::unordered_set<std::uint64_t> vertices, seen;
  for (const TetPlace& place : band)
    for (const LatticePoint& corner : lattice_corners(split, place)) vertices.insert(cell_key(corner));
  cells = 0;
  for (std::size_t n = 0; n < band.size(); ++n) cells += n == 0 || band[n].cell != band[n - 1].cell ? 1 : 0;
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

/// Samples ascending by the tetrahedron that holds them.
std::vector<Sample> sorted_samples(const Samples& samples, const TetMesh& mesh) {
  std::vector<Sample> sorted = samples.samples;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const TetPlace& place = samples.places[k];
    std::size_t t = mesh.first_in_cell.at(cell_key(place.cell));
    while (mesh.places[t] != place) ++t;
    sorted[k].tet = static_cast<std::uint32_t>(t);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const Sample& a, const Sample& b) { return a.tet < b.tet; });
  return sorted;
}

void solve(TetraQuad& surface, const HalfFaces& faces, const std::vector<Sample>& samples, const EnergyWeights& weights,
           TetraQuadFitReport& report, const Context& context) {
  Energy energy = assemble_energy(surface.mesh, faces, samples, weights, context);
  const BlockCholesky factors(energy.matrix, context);
  report.factor_numbers = factors.numbers();
  std::vector<double> x = std::move(energy.right);
  solve_past_ridge(factors, energy.ridge, x);
  surface.quadrics.resize(surface.mesh.lattice.size());
  for (std::size_t v = 0; v < surface.quadrics.size(); ++v)
    std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(kBlock * v), kBlock, surface.quadrics[v].begin());
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

TetraQuad fit(const PointCloud& cloud, const TetraQuadFitOptions& options, const TetraQuadErrorOptions& error,
              TetraQuadFitReport* report_out, const Context& context) {
  check_options(options);
  TetraQuadFitReport report;
  report.resolution = options.resolution;
  const Samples samples = take_samples(cloud, options, report);
  std::size_t cells = 0;
  std::vector<TetPlace> band = first_band(samples, options.split, cells);

  EnergyWeights weights;
  weights.point = static_cast<double>(cells) / static_cast<double>(samples.samples.size());
  weights.normal = options.normal_weight;
  for (std::size_t m = 0; m < 3; ++m) weights.jump[m] = options.smoothness * options.jump[m];
  weights.bending = options.smoothness * options.bending;
  weights.ridge = options.ridge;

  TetraQuad surface;
  surface.georef = cloud.georef;
  surface.mesh = make_tet_mesh(samples.origin, samples.step, options.split, std::move(band));
  HalfFaces faces(surface.mesh.tets, surface.mesh.lattice.size());
  solve(surface, faces, sorted_samples(samples, surface.mesh), weights, report, context);

  std::vector<LatticePoint> data;
  for (const TetPlace& place : samples.places) data.push_back(place.cell);
  std::sort(data.begin(), data.end());
  data.erase(std::unique(data.begin(), data.end()), data.end());
  std::vector<TetPlace> with_points = samples.places;
  std::sort(with_points.begin(), with_points.end());
  with_points.erase(std::unique(with_points.begin(), with_points.end()), with_points.end());
  report.stray = drop_stray(surface, faces, with_points);
  report.growth_rounds = grow(surface, faces, data, kReach, options.growth, weights, context);
  report.stray += drop_stray(surface, faces, with_points);
  report.open_faces = open_faces(surface, faces).size();
  measure(TetraQuadField(surface), sorted_samples(samples, surface.mesh), error, report);
  if (report_out != nullptr) *report_out = std::move(report);
  return surface;
}

}  // namespace

TetraQuad fit_tetraquad(const PointCloud& cloud, const TetraQuadFitOptions& options, TetraQuadFitReport* report,
                        const Context& context) {
  return fit(cloud, options, {}, report, context);
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
  while (true) {
    TetraQuadFitReport report;
    TetraQuad surface = fit(cloud, now, error, &report, context);
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
