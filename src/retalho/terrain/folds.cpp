#include "retalho/terrain/folds.h"

namespace retalho {
namespace {

/// d/dx and d/dy of the plane through three heights, of each height.
std::array<Vec2, 3> plane_basis(const Corners& c) {
  const double twice = cross(c[1] - c[0], c[2] - c[0]);
  std::array<Vec2, 3> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 opposite = c[(k + 2) % 3] - c[(k + 1) % 3];
    result[k] = Vec2{-opposite.y, opposite.x} / twice;
  }
  return result;
}

}  // namespace

Vec2 plane_slope(const Corners& corners, const std::array<double, 3>& heights) {
  const std::array<Vec2, 3> basis = plane_basis(corners);
  // Of differences: where all heights are the same the slope is 0.
  return (heights[1] - heights[0]) * basis[1] + (heights[2] - heights[0]) * basis[2];
}

void fold_corners(const Corners& corners, std::uint8_t folded, CornerData& data) {
  if (folded == 0) return;
  const Vec2 slope = plane_slope(corners, {data[0].x, data[1].x, data[2].x});
  for (std::size_t k = 0; k < 3; ++k)
    if ((folded >> k & 1U) != 0) data[k] = {data[k].x, slope.x, slope.y};
}

void fold_element(const Corners& corners, std::uint8_t folded, FitElement& element) {
  if (folded == 0) return;
  const std::array<Vec2, 3> basis = plane_basis(corners);
  std::array<std::array<double, kMostUnknowns>, kMostUnknowns> a;
  for (std::size_t j = 0; j < kMostUnknowns; ++j)
    for (std::size_t i = 0; i <= j; ++i) a[i][j] = a[j][i] = element.a[packed_index(i, j)];
  // u = P x: the columns, then the rows of A, and b.
  for (std::size_t k = 0; k < 3; ++k) {
    if ((folded >> k & 1U) == 0) continue;
    const std::size_t x = 3 * k + 1, y = x + 1;
    for (auto& row : a) {
      for (std::size_t i = 0; i < 3; ++i) row[3 * i] += row[x] * basis[i].x + row[y] * basis[i].y;
      row[x] = row[y] = 0;
    }
    for (std::size_t j = 0; j < kMostUnknowns; ++j) {
      for (std::size_t i = 0; i < 3; ++i) a[3 * i][j] += a[x][j] * basis[i].x + a[y][j] * basis[i].y;
      a[x][j] = a[y][j] = 0;
    }
    for (std::size_t i = 0; i < 3; ++i) element.b[3 * i] += element.b[x] * basis[i].x + element.b[y] * basis[i].y;
    element.b[x] = element.b[y] = 0;
  }
  for (std::size_t j = 0; j < kMostUnknowns; ++j)
    for (std::size_t i = 0; i <= j; ++i) element.a[packed_index(i, j)] = a[i][j];
}

}  // namespace retalho
