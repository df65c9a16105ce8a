#include "retalho/terrain/terrain.h"

#include <algorithm>
#include <cmath>

#include "retalho/terrain/clough_tocher.h"
#include "retalho/terrain/corners.h"
#include "retalho/terrain/powell_sabin.h"

namespace retalho {
namespace {

struct SurfaceRow {
  SurfaceKind kind;
  const char* name;
  int pieces, coefficients;
};
constexpr SurfaceRow kSurfaces[] = {{SurfaceKind::linear, "linear", 1, 1},
                                    {SurfaceKind::powell_sabin, "powell-sabin", 6, 3},
                                    {SurfaceKind::clough_tocher, "clough-tocher", 3, 3}};

struct GradientRow {
  GradientKind kind;
  const char* name;
};
constexpr GradientRow kGradients[] = {{GradientKind::none, "none"},           {GradientKind::normals, "normals"},
                                      {GradientKind::quadratic, "quadratic"}, {GradientKind::network, "network"},
                                      {GradientKind::given, "given"},         {GradientKind::fitted, "fitted"}};

const SurfaceRow& row(SurfaceKind kind) {
  for (const SurfaceRow& r : kSurfaces)
    if (r.kind == kind) return r;
  return kSurfaces[0];
}

template <int Degree>
void store(TerrainPatch& patch, const TriangleNet<Degree>& net, Vec2 a, Vec2 b, Vec2 c) {
  patch.corners = {a, b, c};
  patch.degree = Degree;
  patch.ordinates = {};
  std::copy(net.begin(), net.end(), patch.ordinates.begin());
}

void powell_sabin_patches(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle,
                          std::array<TerrainPatch, 6>& out) {
  const TriangleCorners c(terrain, triangle);
  const PowellSabinElement e = powell_sabin_element(terrain, edges, triangle);
  const Vec2 centre = c.point[0] + (e.weight[1] * (c.point[1] - c.point[0]) + e.weight[2] * (c.point[2] - c.point[0]));
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const bool forward = c.vertex[i] < c.vertex[j];
    const double fraction = terrain.edge_split[edges.of_triangle[triangle][k]];
    const Vec2 low = forward ? c.point[i] : c.point[j], high = forward ? c.point[j] : c.point[i];
    const Vec2 split = low + fraction * (high - low);  // from the lower index: the same point from both sides
    store<2>(out[2 * k], e.net(static_cast<int>(2 * k)), centre, c.point[i], split);
    store<2>(out[2 * k + 1], e.net(static_cast<int>(2 * k + 1)), centre, split, c.point[j]);
  }
}

void clough_tocher_patches(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle,
                           std::array<TerrainPatch, 6>& out) {
  const TriangleCorners c(terrain, triangle);
  const CloughTocherElement e = clough_tocher_element(terrain, edges, triangle);
  const Vec2 centre = c.point[0] + ((c.point[1] - c.point[0]) + (c.point[2] - c.point[0])) / 3;
  for (std::size_t k = 0; k < 3; ++k)
    store<3>(out[k], e.net(static_cast<int>(k)), c.point[(k + 1) % 3], c.point[(k + 2) % 3], centre);
}

}  // namespace

bool GridDomain::has_data(Vec2 p) const {
  if (columns == 0) return true;
  const double column = std::floor(p.x / cell_width + 0.5), row = std::floor(-p.y / cell_height + 0.5);
  if (!(column >= 0 && row >= 0 && column < columns && row < rows)) return false;
  return valid.empty() || valid.get(static_cast<int>(column), static_cast<int>(row));
}

int patches_per_triangle(SurfaceKind kind) {
  return row(kind).pieces;
}

int triangle_patches(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle,
                     std::array<TerrainPatch, 6>& out) {
  switch (terrain.kind) {
    case SurfaceKind::linear: {
      const TriangleCorners c(terrain, triangle);
      store<1>(out[0], c.height, c.point[0], c.point[1], c.point[2]);
      break;
    }
    case SurfaceKind::powell_sabin:
      powell_sabin_patches(terrain, edges, triangle, out);
      break;
    case SurfaceKind::clough_tocher:
      clough_tocher_patches(terrain, edges, triangle, out);
      break;
  }
  return patches_per_triangle(terrain.kind);
}

const char* surface_name(SurfaceKind kind) {
  return row(kind).name;
}

const char* gradient_name(GradientKind kind) {
  for (const GradientRow& r : kGradients)
    if (r.kind == kind) return r.name;
  return "unknown";
}

std::optional<SurfaceKind> parse_surface(std::string_view name) {
  for (const SurfaceRow& r : kSurfaces)
    if (name == r.name) return r.kind;
  return std::nullopt;
}

std::optional<GradientKind> parse_gradients(std::string_view name) {
  for (const GradientRow& r : kGradients)
    if (name == r.name) return r.kind;
  return std::nullopt;
}

const char* cross_derivative_name(CrossDerivative rule) {
  return rule == CrossDerivative::cubic ? "cubic" : "perpendicular";
}

std::optional<CrossDerivative> parse_cross_derivative(std::string_view name) {
  if (name == "perpendicular") return CrossDerivative::perpendicular;
  if (name == "cubic") return CrossDerivative::cubic;
  return std::nullopt;
}

std::size_t number_count(const Terrain& terrain) {
  return 2 * terrain.tin.vertex_count() + coefficient_count(terrain) + terrain.creases.size();
}

std::size_t coefficient_count(const Terrain& terrain) {
  const std::size_t sectors = std::max(terrain.gradients.size(), terrain.tin.vertex_count());
  return terrain.tin.vertex_count() + static_cast<std::size_t>(row(terrain.kind).coefficients - 1) * sectors;
}

}  // namespace retalho
