// Are two models the same to the last bit?
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "retalho/terrain/terrain.h"

namespace retalho::test {

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// Every member of the model, compared by its bits.
inline bool identical(const Terrain& a, const Terrain& b) {
  const Georef &g = a.georef, &h = b.georef;
  return a.kind == b.kind && a.cross_derivative == b.cross_derivative && a.gradient_kind == b.gradient_kind &&
         same_bits(g.origin_x, h.origin_x) && same_bits(g.origin_y, h.origin_y) && same_bits(g.scale_x, h.scale_x) &&
         same_bits(g.scale_y, h.scale_y) && g.crs_wkt == h.crs_wkt && g.unit == h.unit &&
         g.geographic == h.geographic && a.grid.columns == b.grid.columns && a.grid.rows == b.grid.rows &&
         same_bits(a.grid.cell_width, b.grid.cell_width) && same_bits(a.grid.cell_height, b.grid.cell_height) &&
         a.grid.valid == b.grid.valid && same_bytes(a.tin.points, b.tin.points) &&
         same_bytes(a.tin.heights, b.tin.heights) && same_bytes(a.tin.triangles, b.tin.triangles) &&
         same_bytes(a.tin.neighbors, b.tin.neighbors) && same_bytes(a.gradients, b.gradients) &&
         same_bytes(a.edge_split, b.edge_split) && same_bytes(a.edge_fallback, b.edge_fallback) &&
         same_bits(a.tolerance, b.tolerance);
}

}  // namespace retalho::test
