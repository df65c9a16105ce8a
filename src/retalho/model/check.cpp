#include "retalho/model/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/terrain/creases.h"
#include "retalho/tin/predicates.h"

namespace retalho {
namespace {

bool finite(double v) {
  return std::isfinite(v);
}
bool finite(Vec2 v) {
  return std::isfinite(v.x) && std::isfinite(v.y);
}

template <typename Values>
std::string not_finite(const Values& values, const char* what) {
  const auto at = std::find_if(values.begin(), values.end(), [](const auto& v) { return !finite(v); });
  return at == values.end() ? std::string()
                            : fmt::format("the {} of vertex {} is not a finite number", what, at - values.begin());
}

std::string georef_fault(const Georef& georef) {
  if (!finite(georef.origin_x) || !finite(georef.origin_y)) return "the origin is not finite";
  if (!(georef.scale_x > 0 && georef.scale_y > 0 && finite(georef.scale_x) && finite(georef.scale_y)))
    return "the scale is not a positive number";
  return {};
}

std::string grid_fault(const GridDomain& grid) {
  if (grid.columns < 0 || grid.rows < 0 || (grid.columns == 0) != (grid.rows == 0))
    return fmt::format("a grid of {} x {} cells", grid.columns, grid.rows);
  if (!(grid.cell_width > 0 && grid.cell_height > 0 && finite(grid.cell_width) && finite(grid.cell_height)))
    return "the cell size is not a positive number";
  const Mask& mask = grid.valid;
  if (mask.empty()) return {};
  if (mask.columns() != grid.columns || mask.rows() != grid.rows)
    return fmt::format("a mask of {} x {} cells on a grid of {} x {}", mask.columns(), mask.rows(), grid.columns,
                       grid.rows);
  const std::size_t stride = mask.words().size() / static_cast<std::size_t>(mask.rows());
  const int used = mask.columns() % 64;
  for (std::size_t row = 0; used != 0 && row < static_cast<std::size_t>(mask.rows()); ++row)
    if ((mask.words()[(row + 1) * stride - 1] >> used) != 0)
      return fmt::format("the mask's row {} has bits behind the last column", row);
  return {};
}

std::string tin_fault(const Tin& tin, bool neighbors_built) {
  if (tin.points.size() >= kNone || tin.triangles.size() >= kNone / 3)
    return "more vertices or triangles than 32 bits can number";
  if (tin.heights.size() != tin.points.size())
    return fmt::format("{} heights for {} vertices", tin.heights.size(), tin.points.size());
  if (tin.triangles.empty()) return "no triangles";
  if (std::string fault = not_finite(tin.points, "position"); !fault.empty()) return fault;
  if (std::string fault = not_finite(tin.heights, "height"); !fault.empty()) return fault;
  if (!neighbors_built) {
    Tin twin;
    twin.points = tin.points;
    twin.triangles = tin.triangles;
    build_neighbors(twin);
    if (twin.neighbors != tin.neighbors) return "the triangles' neighbours are not those that share their edges";
  }
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t];
    if (orientation(tin.points[v[0]], tin.points[v[1]], tin.points[v[2]]) <= 0)
      return fmt::format("triangle {} is not counter-clockwise", t);
  }
  return {};
}

/// Creases in order, between two triangles; as many gradients as sectors.
std::string crease_fault(const Terrain& terrain, std::size_t edges) {
  if (terrain.creases.empty())
    return terrain.corner_gradients.empty() ? std::string() : "corners with gradients of their own, but no creases";
  if (terrain.kind == SurfaceKind::linear) return "creases on a linear surface";
  const EdgeTable table = build_edges(terrain.tin);
  for (std::size_t k = 0; k < terrain.creases.size(); ++k) {
    const std::uint32_t e = terrain.creases[k];
    if (e >= edges || (k > 0 && e <= terrain.creases[k - 1])) return "creases that are not ascending numbers of edges";
    if (table.triangles[e][1] == kNone) return fmt::format("crease {} on the border", e);
  }
  std::size_t nodes = 0;
  if (crease_sectors(terrain.tin, table, terrain.creases, &nodes) != terrain.corner_gradients)
    return "the corners' gradients are not those of the creases' sectors";
  if (terrain.gradients.size() != nodes)
    return fmt::format("{} gradients where the creases make {}", terrain.gradients.size(), nodes);
  return {};
}

std::string surface_fault(const Terrain& terrain) {
  const bool smooth = terrain.kind != SurfaceKind::linear;
  const bool split = terrain.kind == SurfaceKind::powell_sabin;
  const bool fallback =
      terrain.kind == SurfaceKind::clough_tocher && terrain.cross_derivative == CrossDerivative::cubic;
  const std::size_t edges = edge_count(terrain.tin);
  const auto wrong_length = [](std::size_t has, std::size_t needs, const char* what) {
    return has == needs ? std::string() : fmt::format("{} {} where the surface has {}", has, what, needs);
  };
  if (std::string f = crease_fault(terrain, edges); !f.empty()) return f;
  if (terrain.creases.empty())
    if (std::string f = wrong_length(terrain.gradients.size(), smooth ? terrain.tin.vertex_count() : 0, "gradients");
        !f.empty())
      return f;
  if (std::string f = wrong_length(terrain.edge_split.size(), split ? edges : 0, "edge splits"); !f.empty()) return f;
  if (std::string f = wrong_length(terrain.edge_fallback.size(), fallback ? edges : 0, "edge fallbacks"); !f.empty())
    return f;
  if (std::string f = not_finite(terrain.gradients, "gradient"); !f.empty()) return f;
  for (std::size_t e = 0; e < terrain.edge_split.size(); ++e)
    if (!(terrain.edge_split[e] > 0 && terrain.edge_split[e] < 1))
      return fmt::format("edge {} is not split within itself", e);
  for (std::size_t e = 0; e < terrain.edge_fallback.size(); ++e)
    if (terrain.edge_fallback[e] > 1) return fmt::format("the fallback of edge {} is neither 0 nor 1", e);
  return {};
}

}  // namespace

std::size_t edge_count(const Tin& tin) {
  std::size_t border = 0;
  for (const auto& n : tin.neighbors) border += static_cast<std::size_t>(std::count(n.begin(), n.end(), kNone));
  return (3 * tin.triangles.size() + border) / 2;
}

std::string find_fault(const Terrain& terrain, bool neighbors_built) {
  if (terrain.kind < SurfaceKind::linear || terrain.kind > SurfaceKind::clough_tocher)
    return "an unknown kind of surface";
  if (terrain.cross_derivative > CrossDerivative::cubic) return "an unknown rule for cross derivatives";
  if (terrain.gradient_kind > GradientKind::fitted) return "an unknown kind of gradients";
  if (!(terrain.tolerance >= 0 && finite(terrain.tolerance))) return "the tolerance is not a number from 0 up";
  for (const auto& fault :
       {georef_fault(terrain.georef), grid_fault(terrain.grid), tin_fault(terrain.tin, neighbors_built)})
    if (!fault.empty()) return fault;
  return surface_fault(terrain);
}

std::string find_fault(const TetraQuad& surface) {
  const TetMesh& mesh = surface.mesh;
  if (std::string fault = georef_fault(surface.georef); !fault.empty()) return fault;
  if (!finite(mesh.origin.x) || !finite(mesh.origin.y) || !finite(mesh.origin.z)) return "the origin is not finite";
  if (!(mesh.step > 0) || !finite(mesh.step)) return "the step of the grid is not a positive number";
  if (mesh.tets.empty()) return "no tetrahedra";
  if (surface.quadrics.size() != mesh.lattice.size())
    return fmt::format("{} quadrics for {} vertices", surface.quadrics.size(), mesh.lattice.size());
  for (std::size_t v = 0; v < surface.quadrics.size(); ++v)
    for (const double c : surface.quadrics[v])
      if (!finite(c)) return fmt::format("the quadric of vertex {} is not finite", v);
  if (mesh.forest) {
    std::vector<std::uint32_t> leaves;
    for (const std::uint32_t leaf : mesh.forest->leaves())
      if (mesh.tet_of_leaf.contains(leaf)) leaves.push_back(leaf);
    const TetMesh made = make_tet_mesh(mesh.origin, mesh.step, mesh.forest, leaves);
    if (made.tets != mesh.tets || made.lattice != mesh.lattice || made.tet_of_leaf != mesh.tet_of_leaf)
      return "its tetrahedra are not leaves of its forest in their order";
    return {};
  }
  const TetMesh made = make_tet_mesh(mesh.origin, mesh.step, mesh.split, mesh.places);
  if (made.places != mesh.places || made.tets != mesh.tets || made.lattice != mesh.lattice)
    return "its tetrahedra are not those of its cells";
  return {};
}

}  // namespace retalho
