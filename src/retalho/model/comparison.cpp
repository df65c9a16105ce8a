#include "retalho/model/comparison.h"

#include "retalho/model/model.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"

namespace retalho {
namespace {

struct Kind {
  SurfaceOptions surface;
  FitKind fit = FitKind::interpolate;
};

std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds;
  const auto add = [&](SurfaceKind surface, GradientKind gradients, FitKind fit = FitKind::interpolate) {
    kinds.push_back({{.surface = surface, .gradients = gradients}, fit});
  };
  const auto smooth = {SurfaceKind::powell_sabin, SurfaceKind::clough_tocher};
  add(SurfaceKind::linear, GradientKind::normals);
  for (const SurfaceKind surface : smooth)
    for (const GradientKind gradients : {GradientKind::normals, GradientKind::quadratic, GradientKind::network})
      add(surface, gradients);
  add(SurfaceKind::clough_tocher, GradientKind::quadratic);
  kinds.back().surface.cross_derivative = CrossDerivative::cubic;
  add(SurfaceKind::linear, GradientKind::normals, FitKind::least_squares);
  for (const SurfaceKind surface : smooth)
    for (const FitKind fit : {FitKind::z_only, FitKind::least_squares}) add(surface, GradientKind::normals, fit);
  return kinds;
}

}  // namespace

ModelReport facts_of(const Terrain& terrain) {
  ModelReport report;
  report.surface = surface_name(terrain.kind);
  report.gradients = gradient_name(terrain.gradient_kind);
  if (terrain.kind == SurfaceKind::clough_tocher)
    report.cross_derivative = cross_derivative_name(terrain.cross_derivative);
  report.vertices = terrain.tin.vertex_count();
  report.triangles = terrain.tin.triangle_count();
  report.coefficients = coefficient_count(terrain);
  report.numbers = number_count(terrain);
  report.tolerance = terrain.tolerance;
  return report;
}

std::string kind_text(const ModelReport& report) {
  if (report.surface == surface_name(SurfaceKind::linear)) return report.surface;
  const bool cubic = report.cross_derivative == cross_derivative_name(CrossDerivative::cubic);
  return report.surface + (cubic ? " cubic " : " ") + report.gradients;
}

std::vector<ModelReport> compare_kinds(const Tin& tin, const Raster& raster, double max_error, const CompareMore& more,
                                       const Context& context) {
  std::vector<ModelReport> reports;
  for (const Kind& kind : all_kinds()) {
    Terrain terrain = make_fitted(tin, raster, kind.surface, kind.fit, context);
    terrain.tolerance = max_error;
    ModelReport report = facts_of(terrain);
    report.name = kind_text(report);
    if (kind.fit != FitKind::interpolate)
      report.name += std::string(" ") + kFitNames[static_cast<std::size_t>(kind.fit)];
    report.bytes = encode_model(terrain).size();
    report.errors = assess(terrain, raster, max_error, context);
    if (more) more(terrain, report);
    reports.push_back(report);
  }
  return reports;
}

}  // namespace retalho
