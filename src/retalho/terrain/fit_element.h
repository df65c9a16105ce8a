// What one triangle adds to the least-squares problem, and the errors of a surface at its cells. Internal to terrain/.
//
//   J(u) = sum_k w_k (S(x_k) - z_k)^2 + mu sum_k |grad S(x_k) - D z_k|^2 + lambda int (Sxx^2 + 2 Sxy^2 + Syy^2)
//
// over the cells k of the triangle, as u'Au - 2 b'u + c.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/terrain/fit_basis.h"
#include "retalho/terrain/fit_grid.h"

namespace retalho {

inline constexpr std::size_t kMostUnknowns = 9;
constexpr std::size_t packed_index(std::size_t i, std::size_t j) {  // i <= j
  return j * (j + 1) / 2 + i;
}

struct FitElement {
  std::array<double, 45> a{};  ///< upper triangle by columns: packed_index
  std::array<double, kMostUnknowns> b{};
  double c = 0;
};

struct FitWeights {
  double slope = 0;                ///< mu
  double fairness = 0;             ///< lambda
  std::span<const float> cells{};  ///< w of each cell of the grid; empty: 1
  Vec2 inside;                     ///< a point inside the mesh's outline, cell coordinates
};

FitElement fit_element(SurfaceKind kind, const FitTriangle& triangle, const FitGrid& grid, const FitWeights& weights);

/// Heights and gradients of the corners, in the units of the fit.
using CornerData = std::array<Vec3, 3>;

/// u'Au - 2 b'u + c.
double element_cost(SurfaceKind kind, const FitElement& element, const CornerData& data);

/// Calls use(cell, error) with S - z at every valid cell of the triangle, `cell` counted row by row.
template <class Use>
void each_error(SurfaceKind kind, const FitTriangle& triangle, const CornerData& data, const FitGrid& grid, Vec2 inside,
                const Use& use) {
  TriangleCorners c;
  c.vertex = triangle.vertex;
  c.point = triangle.corner;
  for (std::size_t k = 0; k < 3; ++k) {
    c.height[k] = data[k].x;
    c.gradient[k] = {data[k].y, data[k].z};
  }
  const auto with = [&]<class Element>() {
    const Element element = make_element<Element>(c, triangle);
    const RowGrid lattice = grid.lattice(), placed = grid.placed_lattice();
    const MacroTriangle macro(triangle.corner);
    RowFan<Element> fan;
    fan.begin(element, macro, triangle.corner, placed, 1 / grid.step.x);
    std::vector<double> heights;
    CellSpans(triangle.at, inside).each(lattice, [&](int row, int first, int last) {
      heights.resize(static_cast<std::size_t>(last - first + 1));
      fan.fill(row, placed.y(row), first, last, heights.data());
      const std::size_t start = grid.cell(first, row);
      for (std::size_t k = 0; k < heights.size(); ++k)
        if (const double z = grid.z[start + k]; !std::isnan(z)) use(start + k, heights[k] - z);
    });
  };
  switch (kind) {
    case SurfaceKind::powell_sabin:
      return with.template operator()<PowellSabinElement>();
    case SurfaceKind::clough_tocher:
      return with.template operator()<CloughTocherElement>();
    default:
      return with.template operator()<LinearElement>();
  }
}

}  // namespace retalho
