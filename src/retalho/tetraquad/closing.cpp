#include "retalho/tetraquad/closing.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "retalho/tetraquad/energy.h"
#include "retalho/tetraquad/fit_parts.h"

namespace retalho {
namespace {

constexpr int kCoarse = 8;  // cubes along the longest side: enough to say where inside is
constexpr int kMargin = 2;  // cubes round the points' box

}  // namespace

ClosedGuide::ClosedGuide(const PointCloud& cloud, const TetraQuadFitOptions& options, const Context& context) {
  TetraQuadFitOptions coarse = options;
  coarse.resolution = std::min(kCoarse, options.resolution);
  TetraQuadFitReport report;
  const Samples samples = take_samples(cloud, coarse, report);
  const std::vector<TetPlace> with_points = occupied_places(samples, coarse.split, context);
  LatticePoint low = with_points[0].cell, high = low;
  std::size_t cells = 0;
  for (std::size_t n = 0; n < with_points.size(); ++n) {
    cells += n == 0 || with_points[n].cell != with_points[n - 1].cell ? 1 : 0;
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], with_points[n].cell[d]);
      high[d] = std::max(high[d], with_points[n].cell[d]);
    }
  }
  std::vector<TetPlace> places;
  for (std::int32_t i = low[0] - kMargin; i <= high[0] + kMargin; ++i)
    for (std::int32_t j = low[1] - kMargin; j <= high[1] + kMargin; ++j)
      for (std::int32_t k = low[2] - kMargin; k <= high[2] + kMargin; ++k)
        for (int type = 0; type < tets_of_cube(coarse.split); ++type)
          places.push_back({{i, j, k}, static_cast<std::uint8_t>(type)});
  TetraQuad surface;
  surface.mesh = make_tet_mesh(samples.origin, samples.step, coarse.split, std::move(places));
  const TetMesh& mesh = surface.mesh;
  const HalfFaces faces(mesh.tets, mesh.lattice.size());
  std::vector<Guide> outside;
  for (const std::uint32_t f : faces.border()) {
    Vec3 p{};
    for (std::size_t i = 0; i < 4; ++i)
      if (i != f % 4) p = p + mesh.to_lattice(mesh.position(mesh.tets[f / 4][i])) / 3;
    outside.push_back({f / 4, p, 1, 1});
  }
  const EnergyWeights weights = weights_of(coarse, static_cast<double>(cells), samples.size());
  solve_energy(assemble_energy(mesh, faces, SampleRuns(samples, mesh, context), weights, context, outside),
               surface.quadrics, nullptr, context);
  add(std::move(surface));
}

void ClosedGuide::add(TetraQuad finer) {
  Level level;
  level.surface = std::make_unique<TetraQuad>(std::move(finer));
  level.field = std::make_unique<TetraQuadField>(*level.surface);
  levels_.push_back(std::move(level));
}

void ClosedGuide::fill(TetraQuad& surface, const std::vector<char>& marked) const {
  const TetMesh& mesh = surface.mesh;
  for (std::size_t v = 0; v < marked.size(); ++v) {
    if (marked[v] == 0) continue;
    std::optional<Jet3> jet;
    for (std::size_t n = levels_.size(); n-- > 0 && !jet;) jet = levels_[n].field->jet(mesh.position(v));
    surface.quadrics[v] = jet ? interpolating_quadric(*jet, mesh.step)
                              : Quadric{levels_[0].surface->mesh.step / mesh.step, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  }
}

bool ClosedGuide::holds(Vec3 p) const {
  return levels_[0].surface->mesh.locate(p) >= 0;
}

ClosedGuide make_guide(const PointCloud& cloud, const TetraQuadFitOptions& options, const Context& context) {
  ClosedGuide guide(cloud, options, context);
  std::vector<int> finer;
  for (int resolution = options.resolution / 2; resolution > kCoarse; resolution /= 2) finer.push_back(resolution);
  for (; !finer.empty(); finer.pop_back()) {
    TetraQuadFitOptions level = options;
    level.resolution = finer.back();
    guide.add(fit_along(cloud, level, guide, context));
  }
  return guide;
}

}  // namespace retalho
