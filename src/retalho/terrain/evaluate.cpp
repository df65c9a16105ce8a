#include "retalho/terrain/evaluate.h"

#include <fmt/format.h>

#include <limits>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/terrain/evaluator_parts.h"

namespace retalho {
namespace {

constexpr double kNoData = std::numeric_limits<double>::quiet_NaN();

template <class Element, class Make>
void fill(std::vector<Element>& elements, std::size_t count, const Context& context, const Make& make) {
  elements.resize(count);
  parallel_chunks(count, 4096, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) elements[t] = make(static_cast<std::uint32_t>(t));
  });
}

/// The height at `p`, looked for from triangle `hint` on; NaN outside. Leaves the triangle in `hint`.
template <class Element>
double value_near(const std::vector<Element>& elements, const PointLocator& locator, Vec2 p, std::uint32_t& hint) {
  prefetch(elements[hint]);
  const std::uint32_t t = locator.locate(p, hint);
  if (t == kNone) return kNoData;
  if (t != hint) prefetch(elements[t]);
  hint = t;
  return element_value(elements[t], MacroTriangle(locator.facet(t).corners).barycentric(p));
}

bool any_void(const GridDomain& grid) {
  return grid.columns > 0 && !grid.valid.empty() &&
         grid.valid.count() < static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
}

}  // namespace

TerrainEvaluator::Parts::Parts(const Terrain& model, const Context& context)
    : terrain(model), edges(build_edges(model.tin)), locator(model.tin, context), has_voids(any_void(model.grid)) {
  const Tin& tin = model.tin;
  switch (model.kind) {
    case SurfaceKind::powell_sabin:
      fill(powell_sabin, tin.triangle_count(), context,
           [&](std::uint32_t t) { return powell_sabin_element(model, edges, t); });
      break;
    case SurfaceKind::clough_tocher:
      fill(clough_tocher, tin.triangle_count(), context,
           [&](std::uint32_t t) { return clough_tocher_element(model, edges, t); });
      break;
    case SurfaceKind::linear:
      fill(linear, tin.triangle_count(), context, [&](std::uint32_t t) {
        const auto& v = tin.triangles[t];
        return LinearElement{{tin.heights[v[0]], tin.heights[v[1]], tin.heights[v[2]]}};
      });
      break;
  }
}

TerrainEvaluator::TerrainEvaluator(const Terrain& terrain, const Context& context)
    : parts_(std::make_unique<Parts>(terrain, context)) {}
TerrainEvaluator::~TerrainEvaluator() = default;
TerrainEvaluator::TerrainEvaluator(TerrainEvaluator&&) noexcept = default;
TerrainEvaluator& TerrainEvaluator::operator=(TerrainEvaluator&&) noexcept = default;

const Terrain& TerrainEvaluator::terrain() const {
  return parts_->terrain;
}
const EdgeTable& TerrainEvaluator::edges() const {
  return parts_->edges;
}

std::uint32_t TerrainEvaluator::locate(Vec2 p, std::uint32_t hint) const {
  return parts_->locator.locate(p, hint);
}

bool TerrainEvaluator::valid(Vec2 p) const {
  return parts_->cell_valid(p) && locate(p) != kNone;
}

double TerrainEvaluator::value(Vec2 p) const {
  std::uint32_t hint = parts_->locator.hint(p);
  if (hint == kNone || !parts_->cell_valid(p)) return kNoData;
  return parts_->with_elements([&](const auto& elements) { return value_near(elements, parts_->locator, p, hint); });
}

std::optional<Jet> TerrainEvaluator::jet(Vec2 p) const {
  if (!parts_->cell_valid(p)) return std::nullopt;
  const std::uint32_t t = locate(p);
  if (t == kNone) return std::nullopt;
  return jet_in(t, p);
}

Jet TerrainEvaluator::jet_in(std::uint32_t triangle, Vec2 p) const {
  return parts_->with_elements([&](const auto& elements) {
    return element_jet(elements[triangle], MacroTriangle(parts_->locator.facet(triangle).corners), p);
  });
}

void TerrainEvaluator::values(std::span<const Vec2> points, std::span<double> out, const Context& context) const {
  if (out.size() != points.size())
    throw UsageError(fmt::format("values: {} points, but room for {} heights", points.size(), out.size()));
  const PointLocator& locator = parts_->locator;
  parts_->with_elements([&](const auto& elements) {
    parallel_chunks(points.size(), 16384, context, [&](std::size_t begin, std::size_t end) {
      std::uint32_t last = kNone;  // where the point before was found: a chunk starts afresh
      for (std::size_t k = begin; k < end; ++k) {
        const Vec2 p = points[k];
        if (last == kNone || !locator.holds_inside(last, p)) last = locator.hint(p);
        out[k] = last == kNone || !parts_->cell_valid(p) ? kNoData : value_near(elements, locator, p, last);
      }
    });
  });
}

Raster raster_of_cells(const TerrainEvaluator& evaluator, const Context& context) {
  const Terrain& terrain = evaluator.terrain();
  const GridDomain& grid = terrain.grid;
  if (grid.columns == 0)
    throw BadInput("the model was made from points and has no cells: sample it on a raster first (--resolution)");
  Raster raster;
  raster.columns = grid.columns;
  raster.rows = grid.rows;
  raster.cell_width = grid.cell_width;
  raster.cell_height = grid.cell_height;
  raster.georef = terrain.georef;
  std::vector<double> heights(raster.cells());
  evaluator.grid_values({0, 0}, {grid.cell_width, grid.cell_height}, grid.columns, grid.rows, heights, {}, context);
  raster.heights = std::move(heights);
  return raster;
}

}  // namespace retalho
