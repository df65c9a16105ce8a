#include "retalho/level/surface_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "retalho/core/parallel.h"
#include "retalho/core/variants.h"
#include "retalho/terrain/bicubic.h"

namespace retalho {
namespace {

struct RowSize {
  double height = 0, ends = 0;  ///< largest magnitudes, of all samples and of the first and last one
  double beside = 0,
         below = 0;  ///< largest differences, to the next sample and to the next row
  bool voids = false;

  void join(const RowSize& other) {
    height = std::max(height, other.height);
    ends = std::max(ends, other.ends);
    beside = std::max(beside, other.beside);
    below = std::max(below, other.below);
    voids |= other.voids;
  }
};

/// Of n samples, n >= 2; `below`: the next row, or the same one.
template <class T>
RETALHO_VARIANTS RowSize size_of_row(const T* z, const T* below, std::size_t n) {
  constexpr std::size_t kLanes = 8;
  std::array<T, kLanes> height{}, beside{}, under{}, sum{};
  const auto take = [&](std::size_t x, std::size_t l) {
    const T h = std::abs(z[x]), b = std::abs(z[x + 1] - z[x]), u = std::abs(below[x] - z[x]);
    height[l] = height[l] < h ? h : height[l];
    beside[l] = beside[l] < b ? b : beside[l];
    under[l] = under[l] < u ? u : under[l];
    sum[l] += h - h;  // stays zero without a void
  };
  std::size_t x = 0;
  for (; x + kLanes < n; x += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) take(x + l, l);
  for (; x + 1 < n; ++x) take(x, 0);
  const T last = std::abs(z[n - 1]), u = std::abs(below[n - 1] - z[n - 1]);
  height[0] = std::max(height[0], last);
  under[0] = std::max(under[0], u);
  sum[0] += last - last;
  RowSize r;
  for (std::size_t l = 0; l < kLanes; ++l) {
    r.height = std::max(r.height, static_cast<double>(height[l]));
    r.beside = std::max(r.beside, static_cast<double>(beside[l]));
    r.below = std::max(r.below, static_cast<double>(under[l]));
    r.voids |= !(sum[l] == 0);
  }
  r.ends = std::max(static_cast<double>(std::abs(z[0])), static_cast<double>(last));
  return r;
}

}  // namespace

SurfaceSize bound_surface(const Raster& raster, int block_rows, const Context& context) {
  const int rows = raster.rows;
  std::vector<RowSize> sizes(static_cast<std::size_t>(rows));
  std::visit(
      [&](const auto& heights) {
        parallel_chunks(sizes.size(), 64, context, [&](std::size_t from, std::size_t to) {
          for (std::size_t r = from; r < to; ++r) {
            const std::size_t below = std::min(r + 1, sizes.size() - 1);
            sizes[r] = size_of_row(heights.data() + raster.index(0, static_cast<int>(r)),
                                   heights.data() + raster.index(0, static_cast<int>(below)),
                                   static_cast<std::size_t>(raster.columns));
          }
        });
      },
      raster.heights);
  SurfaceSize size;
  for (const RowSize& row : sizes) size.least = std::max(size.least, row.height);
  int exponent = 0;
  std::frexp(size.least, &exponent);
  const double limit = std::ldexp(1.0, exponent);
  for (int first = 0; first < rows; first += block_rows) {
    const SizeBlock block{first, std::min(rows, first + block_rows)};
    // Rows near the grid's ends are not reckoned with, as they have larger tangents along v.
    RowSize own, around;
    const int above = first - kSplineHalo - 1, below = block.last + kSplineHalo + 1;
    bool sure = above >= 0 && below <= rows;
    for (int r = std::max(above, 0); r < std::min(below, rows); ++r) {
      around.join(sizes[static_cast<std::size_t>(r)]);
      if (r >= block.first && r < block.last) own.join(sizes[static_cast<std::size_t>(r)]);
    }
    const double steep = std::max(around.beside, around.below);
    // A third of both tangents, a ninth of the twist.
    const double inside = own.height + around.beside + around.below + 2 * steep;
    const double at_ends = own.ends + 3 * around.beside + around.below + 6 * steep;
    sure = sure && !around.voids && std::max(inside, at_ends) * (1 + 1e-6) < limit;
    if (!sure) size.unsure.push_back(block);
  }
  return size;
}

}  // namespace retalho
