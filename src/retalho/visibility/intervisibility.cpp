#include "retalho/visibility/intervisibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/raster/part.h"
#include "retalho/visibility/ray_kernel.h"
#include "retalho/visibility/viewshed.h"

namespace retalho {
namespace {

using namespace visibility_detail;

constexpr int kNearReach = 16;  // cross edges farther out hide targets that the exact count sees (bias -0.1 %)

/// One of the four ways that rays can run: their major axis is the columns' or the rows', in either direction.
struct Orientation {
  bool along_rows, reversed;
};

RayGrid lay_out(const Raster& raster, Orientation o) {
  RayGrid grid;
  grid.columns = o.along_rows ? raster.rows : raster.columns;
  grid.rows = o.along_rows ? raster.columns : raster.rows;
  grid.padding = kBlockLarge + 2 * kMaxLanes + 8;
  grid.stride = static_cast<std::size_t>(grid.rows + 2 * grid.padding + kMaxLanes);
  grid.heights.assign(static_cast<std::size_t>(grid.columns + 1) * grid.stride, kOutside);
  for (int u = 0; u < grid.columns; ++u) {
    const int along = o.reversed ? grid.columns - 1 - u : u;
    float* column =
        grid.heights.data() + static_cast<std::size_t>(u) * grid.stride + static_cast<std::size_t>(grid.padding);
    for (int v = 0; v < grid.rows; ++v) {
      const double z = o.along_rows ? raster.at(v, along) : raster.at(along, v);
      column[v] = std::isnan(z) ? kOutside : static_cast<float>(z);
    }
    column[-1] = column[0];
    column[grid.rows] = column[grid.rows - 1];
  }
  return grid;
}

/// out[i] = the largest of in[i + low .. i + high].
void slide_maximum(const std::vector<float>& in, int low, int high, std::vector<float>& out) {
  const auto n = static_cast<std::ptrdiff_t>(in.size());
  const std::ptrdiff_t window = high - low + 1;
  std::vector<float> run = in;  // run[i] = max of in[i .. i + length - 1]
  std::ptrdiff_t length = 1;
  for (; length * 2 <= window; length *= 2)
    for (std::ptrdiff_t i = 0; i + length < n; ++i)
      run[static_cast<std::size_t>(i)] =
          std::max(run[static_cast<std::size_t>(i)], run[static_cast<std::size_t>(i + length)]);
  out.assign(in.size(), kOutside);
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t a = std::clamp<std::ptrdiff_t>(i + low, 0, n - 1),
                         b = std::clamp<std::ptrdiff_t>(i + high - length + 1, 0, n - 1);
    out[static_cast<std::size_t>(i)] = std::max(run[static_cast<std::size_t>(a)], run[static_cast<std::size_t>(b)]);
  }
}

/// Highest cells of blocks of `width` columns over the rows that a ray of that sign drifts through.
std::vector<float> block_maxima(const RayGrid& grid, int width, bool upward) {
  std::vector<float> blocks(static_cast<std::size_t>(grid.columns / width + 1) * grid.stride, kOutside);
  std::vector<float> highest(grid.stride), slid;
  for (int block = 0; block * width < grid.columns; ++block) {
    std::fill(highest.begin(), highest.end(), kOutside);
    for (int u = block * width; u < std::min(grid.columns, (block + 1) * width); ++u)
      for (std::size_t v = 0; v < grid.stride; ++v)
        highest[v] = std::max(highest[v], grid.heights[static_cast<std::size_t>(u) * grid.stride + v]);
    slide_maximum(highest, upward ? 0 : -width - 1, upward ? width + 1 : 1, slid);
    std::copy(slid.begin(), slid.end(),
              blocks.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(block) * grid.stride));
  }
  return blocks;
}

/// Everything about one azimuth. Distances are in cells along the major axis; `aspect` is the minor cell size over the
/// major one, and areas are in cells.
RaySlope make_slope(double slope, int reach, double sector) {
  RaySlope s;
  s.slope = slope;
  s.reach = reach;
  const auto n = static_cast<std::size_t>(reach) + 1;
  s.row_offset.resize(n);
  s.fraction.resize(n);
  s.inverse.resize(n);
  s.weight.resize(n);
  s.near_reach = std::min(kNearReach, reach);
  s.cross_row.resize(n);
  s.cross_fraction.resize(n);
  s.cross_inverse.assign(n, 0);
  for (std::size_t d = 1; d < n; ++d) {
    const double distance = static_cast<double>(d), row = distance * slope;
    s.row_offset[d] = static_cast<int>(std::floor(row));
    s.fraction[d] = static_cast<float>(row - std::floor(row));
    s.inverse[d] = static_cast<float>(1 / distance);
    s.weight[d] = static_cast<float>(distance * sector);
    if (d < 2 || d > static_cast<std::size_t>(s.near_reach)) continue;
    const double before = (distance - 1) * slope, low = std::min(before, row), high = std::max(before, row),
                 line = std::floor(high);
    if (!(line > low + 1e-9 && line < high - 1e-9)) continue;
    const double at = line / slope;  // where the ray crosses that row's line
    s.cross_row[d] = static_cast<int>(line);
    s.cross_fraction[d] = static_cast<float>(at - (distance - 1));
    s.cross_inverse[d] = static_cast<float>(1 / at);
  }
  return s;
}

using Kernel = void (*)(const RayGrid&, const RaySlope&, int, int, float, float, float*);

Kernel choose_kernel() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return add_rays_avx2;
#endif
  return add_rays_generic;
}

}  // namespace

std::vector<float> intervisibility_map(const Raster& raster, const IntervisibilityOptions& options,
                                       const Context& context) {
  if (options.directions < 4)
    throw UsageError(fmt::format("{} directions are too few: give at least 4 (180 is usual)", options.directions));
  const Kernel add_rays = choose_kernel();
  std::vector<float> map(raster.cells(), 1.0F);  // every cell sees itself
  const double step = 2 * std::numbers::pi / options.directions;
  double done = 0;
  context.report("intervisibility", done);  // who stops the work from here need not wait for its first part
  for (const Orientation o : {Orientation{false, false}, {true, false}, {false, true}, {true, true}}) {
    RayGrid grid = lay_out(raster, o);
    const double major = o.along_rows ? raster.cell_height : raster.cell_width,
                 minor = o.along_rows ? raster.cell_width : raster.cell_height;
    std::vector<float> seen(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0.0F);
    for (const bool upward : {true, false}) {
      // Azimuths in true directions; rays whose row slope in cells is within [-1, 1] run along this axis.
      std::vector<RaySlope> slopes;
      for (int i = 0; i < options.directions; ++i) {
        const double angle = (i + 0.5) * step, east = std::cos(angle) / raster.cell_width,
                     south = std::sin(angle) / raster.cell_height;
        const double along = (o.along_rows ? south : east) * (o.reversed ? -1 : 1),
                     across = o.along_rows ? east : south;
        if (along <= 0) continue;
        const double slope = across / along;
        if (o.along_rows ? std::abs(slope) >= 1 - 1e-12 : std::abs(slope) > 1 + 1e-12) continue;
        if ((slope >= 0) != upward) continue;
        // A piece of the sector between columns d - 1/2 and d + 1/2 is r dr dtheta, in cells.
        const double stretch = 1 + slope * slope * (minor / major) * (minor / major);
        const double sector = stretch * step * major / minor;
        int reach = grid.columns - 1;
        if (options.radius > 0)
          reach = std::min<int>(reach, static_cast<int>(std::floor(options.radius / (major * std::sqrt(stretch)))));
        slopes.push_back(make_slope(slope, reach, sector));
      }
      grid.block_small = block_maxima(grid, kBlockSmall, upward);
      grid.block_large =
          grid.columns > 2 * kBlockLarge ? block_maxima(grid, kBlockLarge, upward) : std::vector<float>{};
      // Observer columns go to the workers in blocks; each adds its azimuths in the same order, so the sums are the
      // same.
      parallel_chunks(static_cast<std::size_t>(grid.columns), 16, context, [&](std::size_t begin, std::size_t end) {
        for (const RaySlope& slope : slopes) {
          context.check();
          add_rays(grid, slope, static_cast<int>(begin), static_cast<int>(end), static_cast<float>(options.eye_height),
                   static_cast<float>(options.target_height), seen.data());
        }
      });
      done += 0.125;
      context.report("intervisibility", done);
    }
    for (int u = 0; u < grid.columns; ++u) {
      const int along = o.reversed ? grid.columns - 1 - u : u;
      for (int v = 0; v < grid.rows; ++v)
        map[o.along_rows ? raster.index(v, along) : raster.index(along, v)] +=
            seen[static_cast<std::size_t>(u) * static_cast<std::size_t>(grid.rows) + static_cast<std::size_t>(v)];
    }
  }
  for (std::size_t i = 0; i < map.size(); ++i)
    if (std::isnan(raster.at(i))) map[i] = std::numeric_limits<float>::quiet_NaN();
  return map;
}

std::vector<float> exact_intervisibility(const Raster& raster, int stride, const IntervisibilityOptions& options,
                                         const Context& context) {
  check_stride(raster, stride);
  std::vector<float> map(raster.cells(), std::numeric_limits<float>::quiet_NaN());
  const ViewshedOptions field{.target_height = options.target_height, .radius = options.radius};
  std::vector<std::size_t> observers;
  for (int row = stride / 2; row < raster.rows; row += stride)
    for (int column = stride / 2; column < raster.columns; column += stride)
      if (raster.valid(column, row)) observers.push_back(raster.index(column, row));
  Context single = context;
  single.threads = 1;
  single.progress = nullptr;
  parallel_chunks(observers.size(), 4, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int row = static_cast<int>(observers[i] / static_cast<std::size_t>(raster.columns)),
                column = static_cast<int>(observers[i] % static_cast<std::size_t>(raster.columns));
      const auto seen = viewshed(raster, {column, row, options.eye_height}, field, single);
      map[observers[i]] = static_cast<float>(std::count(seen.begin(), seen.end(), 1));
    }
  });
  return map;
}

MapDifference compare_maps(std::span<const float> map, std::span<const float> reference) {
  if (map.size() != reference.size())
    throw UsageError(fmt::format("maps of {} and {} cells: they must be of one grid", map.size(), reference.size()));
  MapDifference result;
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (std::isnan(map[i]) || std::isnan(reference[i])) continue;
    const double d = static_cast<double>(map[i]) - static_cast<double>(reference[i]);
    sum += d;
    squares += d * d;
    result.maximum = std::max(result.maximum, std::abs(d));
    ++result.cells;
  }
  if (result.cells > 0) {
    result.mean = sum / static_cast<double>(result.cells);
    result.rmse = std::sqrt(squares / static_cast<double>(result.cells));
  }
  return result;
}

}  // namespace retalho
