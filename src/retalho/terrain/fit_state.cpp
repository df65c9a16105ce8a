#include "retalho/terrain/fit_state.h"

#include <algorithm>
#include <numeric>

#include "retalho/core/parallel.h"
#include "retalho/terrain/creases.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/folded_surface.h"
#include "retalho/terrain/folds.h"
#include "retalho/tin/grid_hull.h"

namespace retalho {
std::vector<greedy::Cell> box_of_valid(const Raster& raster) {
  const std::vector<greedy::Cell> hull = greedy::hull_of_valid(raster);
  int left = raster.columns, right = 0, top = raster.rows, bottom = 0;
  for (const greedy::Cell c : hull) {
    left = std::min(left, greedy::column_of(c));
    right = std::max(right, greedy::column_of(c));
    top = std::min(top, greedy::row_of(c));
    bottom = std::max(bottom, greedy::row_of(c));
  }
  using greedy::cell_at;
  return {cell_at(left, top), cell_at(right, top), cell_at(right, bottom), cell_at(left, bottom)};
}

FitState::FitState(const Raster& raster, SurfaceKind surface, const Context& context)
    : FitState(raster, surface, CellMesh(box_of_valid(raster)), context) {}

FitState::FitState(const Raster& raster, SurfaceKind surface, CellMesh on, const Context& context)
    : kind(surface), grid(raster, context), mesh(std::move(on)) {
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    const double z = height(mesh.cell(v));
    data.push_back({std::isnan(z) ? 0 : z, 0, 0});
  }
  pinned.assign(data.size(), 0);
  weights.inside = (mesh.at(0) + mesh.at(1) + mesh.at(2)) / 3;
}

FitTriangle FitState::triangle(std::uint32_t t, std::uint32_t moved, Vec2 to) const {
  const auto place = [&](std::uint32_t v) { return v == moved ? to : mesh.at(v); };
  FitTriangle result;
  result.vertex = mesh.triangles()[t];
  for (std::size_t k = 0; k < 3; ++k) {
    result.at[k] = place(result.vertex[k]);
    result.corner[k] = grid.place(result.at[k]);
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (is_folded(result.vertex[k])) result.folded |= static_cast<std::uint8_t>(1U << k);
  if (kind != SurfaceKind::powell_sabin) return result;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t n = mesh.neighbors()[t][k];
    if (n == kNone) continue;
    std::size_t low = (k + 1) % 3, high = (k + 2) % 3;
    if (result.vertex[low] > result.vertex[high]) std::swap(low, high);
    for (const std::uint32_t far : mesh.triangles()[n])
      if (far != result.vertex[low] && far != result.vertex[high])
        result.split[k] =
            powell_sabin_split(result.corner[low], result.corner[high], result.corner[k], grid.place(place(far)));
  }
  return result;
}

CornerData FitState::corner_data(std::uint32_t t) const {
  const auto& v = mesh.triangles()[t];
  CornerData corners{data[v[0]], data[v[1]], data[v[2]]};
  if (!folded.empty()) {
    const FitTriangle here = triangle(t);
    fold_corners(here.corner, here.folded, corners);
  }
  return corners;
}

void FitState::refresh(const Context& context, bool all) {
  std::vector<std::uint32_t> list;
  if (all) {
    list.resize(mesh.triangle_count());
    std::iota(list.begin(), list.end(), 0U);
  } else {
    list = mesh.changed();
    if (kind == SurfaceKind::powell_sabin) {  // the neighbours' incentres set the splits
      const std::size_t count = list.size();
      for (std::size_t k = 0; k < count; ++k)
        for (const std::uint32_t n : mesh.neighbors()[list[k]])
          if (n != kNone && !mesh.is_changed(n)) list.push_back(n);
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
  }
  elements.resize(mesh.triangle_count());
  weights.cells = cell_weights;
  parallel_chunks(list.size(), 32, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) elements[list[k]] = fit_element(kind, triangle(list[k]), grid, weights);
  });
  mesh.clear_changed();
}

int FitState::solve(const CgLimits& limits, const Context& context) {
  FitSolveOptions options;
  options.limits = limits;
  if (std::any_of(pinned.begin(), pinned.end(), [](std::uint8_t p) { return p != 0; })) options.pinned = pinned;
  return solve_fit(kind, mesh.triangles(), elements, {}, data, options, context);
}

std::vector<double> FitState::costs(const Context& context) const {
  std::vector<double> result(mesh.triangle_count());
  parallel_chunks(result.size(), 4096, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      result[t] = element_cost(kind, elements[t], corner_data(static_cast<std::uint32_t>(t)));
  });
  return result;
}

double FitState::cost(const Context& context) const {
  const std::vector<double> all = costs(context);
  const auto gradients = static_cast<double>(std::count(folded.begin(), folded.end(), 0));
  return std::accumulate(all.begin(), all.end(), 0.0) + gradient_price * gradients;
}

void FitState::set_gradient_price() {
  if (folded.empty()) return;
  const auto gradients = static_cast<double>(std::count(folded.begin(), folded.end(), 0));
  const double cost_alone = cost({}) - gradient_price * gradients;
  const double numbers = 3 * static_cast<double>(folded.size()) + 2 * gradients;
  gradient_price = 1.5 * cost_alone / numbers;
}

Vec3 FitState::surface_at(std::uint32_t t, CellMesh::Cell cell) const {
  const FitTriangle triangle_here = triangle(t);
  const CornerData corners = corner_data(t);
  TriangleCorners c;
  c.vertex = triangle_here.vertex;
  c.point = triangle_here.corner;
  for (std::size_t k = 0; k < 3; ++k) {
    c.height[k] = corners[k].x;
    c.gradient[k] = {corners[k].y, corners[k].z};
  }
  const Vec2 p = grid.place({static_cast<double>(greedy::column_of(cell)), -static_cast<double>(greedy::row_of(cell))});
  const MacroTriangle macro(triangle_here.corner);
  const auto with = [&](const auto& element) {
    const Jet jet = element_jet(element, macro, p);
    return Vec3{jet.value, jet.gradient.x, jet.gradient.y};
  };
  switch (kind) {
    case SurfaceKind::powell_sabin:
      return with(make_element<PowellSabinElement>(c, triangle_here));
    case SurfaceKind::clough_tocher:
      return with(make_element<CloughTocherElement>(c, triangle_here));
    default:
      return with(make_element<LinearElement>(c, triangle_here));
  }
}

bool FitState::insert(CellMesh::Cell cell, std::uint32_t t, Vec3 at) {
  if (mesh.insert(cell, t) == kNone) return false;
  data.push_back(at);
  pinned.push_back(0);
  if (!folded.empty()) folded.push_back(0);
  return true;
}

bool FitState::remove(std::uint32_t vertex) {
  if (!mesh.remove(vertex)) return false;
  data[vertex] = data.back();
  data.pop_back();
  pinned[vertex] = pinned.back();
  pinned.pop_back();
  if (folded.empty()) return true;
  folded[vertex] = folded.back();
  folded.pop_back();
  return true;
}

Terrain to_terrain(const FitState& state, const Raster& raster, const Context& context,
                   std::span<const std::array<std::uint32_t, 2>> creases) {
  const std::size_t n = state.mesh.vertex_count();
  std::vector<std::uint32_t> order(n), number(n);  // vertices in raster order
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return state.mesh.cell(a) < state.mesh.cell(b); });
  for (std::uint32_t k = 0; k < n; ++k) number[order[k]] = k;
  Tin tin;
  std::vector<Vec2> gradients;
  std::vector<std::uint8_t> folds;
  for (const std::uint32_t v : order) {
    if (!state.folded.empty()) folds.push_back(state.folded[v]);
    const CellMesh::Cell cell = state.mesh.cell(v);
    const int column = greedy::column_of(cell), row = greedy::row_of(cell);
    tin.points.push_back(raster.centre(column, row));
    tin.heights.push_back(state.pinned[v] != 0 ? raster.at(column, row) : state.data[v].x + state.grid.reference);
    gradients.push_back(Vec2{state.data[v].y, state.data[v].z} / state.grid.unit);
  }
  for (const auto& t : state.mesh.triangles()) {
    std::array<std::uint32_t, 3> mapped{number[t[0]], number[t[1]], number[t[2]]};
    std::rotate(mapped.begin(), std::min_element(mapped.begin(), mapped.end()), mapped.end());
    tin.triangles.push_back(mapped);
  }
  std::sort(tin.triangles.begin(), tin.triangles.end());
  SurfaceOptions options{.surface = state.kind, .gradients = GradientKind::given};
  if (!creases.empty()) {
    build_neighbors(tin);
    const EdgeTable edges = build_edges(tin);
    std::vector<std::array<std::uint32_t, 2>> wanted;
    for (const auto& [a, b] : creases)
      wanted.push_back({std::min(number[a], number[b]), std::max(number[a], number[b])});
    std::sort(wanted.begin(), wanted.end());
    for (std::uint32_t e = 0; e < edges.vertices.size(); ++e)
      if (std::binary_search(wanted.begin(), wanted.end(), edges.vertices[e])) options.creases.push_back(e);
    std::size_t nodes = 0;
    const auto sectors = crease_sectors(tin, edges, options.creases, &nodes);
    const std::vector<std::uint32_t> vertex = sector_vertices(tin, sectors, nodes);
    for (std::size_t k = n; k < nodes; ++k) gradients.push_back(gradients[vertex[k]]);
  }
  if (std::find(folds.begin(), folds.end(), 1) != folds.end()) {
    build_neighbors(tin);
    FoldedSurface surface = folded_surface(tin, folds, gradients);
    options.creases = std::move(surface.creases);
    gradients = std::move(surface.gradients);
  }
  if (state.kind != SurfaceKind::linear) options.given = std::move(gradients);
  Terrain terrain = make_terrain(std::move(tin), raster, options, context);
  if (state.kind != SurfaceKind::linear) terrain.gradient_kind = GradientKind::fitted;
  return terrain;
}

}  // namespace retalho
