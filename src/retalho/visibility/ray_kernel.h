// The inner loop of the intervisibility map: rays of one slope from a block of observer columns, a lane an observer.
// It is compiled twice, for machines with and without AVX2 (ray_kernel_*.cpp); both give the same bytes, since each
// lane's operations are the same and a block is skipped only where it cannot matter.
#pragma once

#include <cstddef>
#include <vector>

namespace retalho::visibility_detail {

inline constexpr int kBlockSmall = 16;   ///< columns in a block of the first skip level
inline constexpr int kBlockLarge = 128;  ///< and of the second
inline constexpr int kMaxLanes = 16;
inline constexpr float kOutside = -1e30F;  ///< height of void cells and of what lies beyond the border
inline constexpr float kLowest = -1e20F;   ///< horizon at the start: above kOutside, so that nothing is not seen

/// Heights laid out for one orientation: U columns along the rays' major axis, V contiguous rows, padded on both sides.
struct RayGrid {
  int columns = 0, rows = 0;  // U, V
  int padding = 0;
  std::size_t stride = 0;                       // of a column
  std::vector<float> heights;                   // (U + 1) columns
  std::vector<float> block_small, block_large;  // the highest cell of each block over the drift of its rays

  const float* column(int u) const {
    return heights.data() + static_cast<std::size_t>(u) * stride + static_cast<std::size_t>(padding);
  }
};

/// All that depends on the slope alone, for every distance d = 1 .. reach in columns.
struct RaySlope {
  double slope = 0;  // rows a column, in [-1, 1]
  int reach = 0;
  std::vector<int> row_offset;  // floor(d * slope)
  std::vector<float> fraction, inverse, weight;
  int near_reach = 0;  // cross edges are tested up to here
  std::vector<int> cross_row;
  std::vector<float> cross_fraction, cross_inverse;  // cross_inverse 0: no crossing between d - 1 and d
};

/// Adds, for each observer (u, v) with u in [first, last), the area that its ray of this slope sees to
/// seen[u * rows + v].
void add_rays_generic(const RayGrid& grid, const RaySlope& slope, int first, int last, float eye, float target,
                      float* seen);
void add_rays_avx2(const RayGrid& grid, const RaySlope& slope, int first, int last, float eye, float target,
                   float* seen);

}  // namespace retalho::visibility_detail
