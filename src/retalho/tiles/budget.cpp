// A budget of vertices as the tolerance that spends it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/core/error.h"
#include "retalho/tiles/plan.h"
#include "retalho/tin/refine.h"

namespace retalho {
namespace {

constexpr double kSpent = 0.98;  // of the budget: good enough
constexpr int kTrials = 24;
constexpr double kFinest = 1e-9;      // of the range of heights: a budget that is not spent here takes every cell
constexpr double kNarrow = 1e-4;      // ratio of tolerances that are not worth a further trial
constexpr double kFirstTrial = 0.01;  // of the range

std::size_t place_of(const TiledIndex& frame, int row, int column) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(frame.tile_columns()) +
         static_cast<std::size_t>(column);
}

/// Counts fall about as a power of the tolerance: the trial lies on the line through both ends in logarithms.
class Search {
 public:
  Search(std::size_t budget, double range, const std::function<std::size_t(double)>& count)
      : budget_(budget), range_(range), count_(count) {}

  double run() {
    coarse_ = range_;
    coarse_count_ = count_(range_);
    if (coarse_count_ > budget_)
      throw UsageError(
          fmt::format("a budget of {} vertices: the corners and outlines of the tiles alone are {}; give a "
                      "larger budget or larger tiles",
                      budget_, coarse_count_),
          {}, "--vertices");
    for (int k = 0; k < kTrials && !spent(); ++k) {
      if (fine_ > 0 && coarse_ < fine_ * (1 + kNarrow)) break;
      const double trial = next(k);
      const std::size_t n = count_(trial);
      if (n > budget_) {
        fine_ = trial;
        fine_count_ = n;
      } else {
        coarse_ = trial;
        coarse_count_ = n;
        if (trial <= range_ * kFinest) break;
      }
    }
    return coarse_;
  }

 private:
  bool spent() const { return static_cast<double>(coarse_count_) >= kSpent * static_cast<double>(budget_); }

  double next(int k) const {
    const auto wanted = static_cast<double>(budget_) * (1 + kSpent) / 2;
    if (fine_ == 0) {
      if (k == 0) return range_ * kFirstTrial;
      const double guess = coarse_ * static_cast<double>(coarse_count_) / wanted;
      return std::max(range_ * kFinest, std::clamp(guess, coarse_ / 64, coarse_ / 1.5));
    }
    const double low = std::log(fine_), high = std::log(coarse_);
    const double few = std::log(static_cast<double>(coarse_count_)), many = std::log(static_cast<double>(fine_count_));
    const double share = k % 4 == 3 || !(many > few) ? 0.5 : (many - std::log(wanted)) / (many - few);
    return std::exp(low + (high - low) * std::clamp(share, 0.05, 0.95));
  }

  std::size_t budget_;
  double range_;
  const std::function<std::size_t(double)>& count_;
  double coarse_ = 0, fine_ = 0;  // at most the budget; more than it (0: none seen)
  std::size_t coarse_count_ = 0, fine_count_ = 0;
};

}  // namespace

TileLook look_at_tile(const TilePlan& plan, int tile_row, int tile_column, const Context& context) {
  const Raster raster = read_tile(plan, tile_row, tile_column, context);
  TileLook look;
  look.area = has_area(raster);
  look.low = std::numeric_limits<double>::infinity();
  look.high = -look.low;
  for (int r = 0; r < raster.rows; ++r)
    for (int c = 0; c < raster.columns; ++c) {
      const double z = raster.at(c, r);
      if (std::isnan(z)) continue;
      look.low = std::min(look.low, z);
      look.high = std::max(look.high, z);
      if ((r > 0 || tile_row == 0) && (c > 0 || tile_column == 0)) ++look.valid;
    }
  return look;
}

std::array<bool, 9> areas_around(const TiledIndex& frame, const std::vector<TileLook>& looks, int tile_row,
                                 int tile_column) {
  std::array<bool, 9> area{};
  for (int k = 0; k < 9; ++k) {
    const int r = tile_row - 1 + k / 3, c = tile_column - 1 + k % 3;
    if (r >= 0 && c >= 0 && r < frame.tile_rows() && c < frame.tile_columns())
      area[static_cast<std::size_t>(k)] = looks.at(place_of(frame, r, c)).area;
  }
  return area;
}

std::size_t count_vertices(const TilePlan& plan, int tile_row, int tile_column, double max_error,
                           const std::array<bool, 9>& area, const Context& context) {
  if (!area[4]) return 0;
  const Raster raster = read_tile(plan, tile_row, tile_column, context);
  const GridTin tin = refine_grid(raster, {.max_error = max_error}, context);
  std::size_t own = 0;
  for (const std::uint32_t cell : tin.cells) {
    const bool north = (cell >> 16) == 0, west = (cell & 0xffffU) == 0;
    const bool east = static_cast<int>(cell & 0xffffU) == raster.columns - 1;
    // Row by row, the tiles before this one that have the cell: those in the north, and the western one.
    const bool other = (north && (area[1] || (west && area[0]) || (east && area[2]))) || (west && area[3]);
    own += other ? 0 : 1;
  }
  return own;
}

TilePlan settle(TilePlan plan, const std::vector<TileLook>& looks, const std::function<std::size_t(double)>& count) {
  if (looks.size() != plan.frame.tile_count())
    throw UsageError(fmt::format("{} looks at tiles, where the grid has {}", looks.size(), plan.frame.tile_count()));
  std::size_t valid = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const TileLook& look : looks) {
    valid += look.valid;
    if (!look.area) continue;
    low = std::min(low, look.low);
    high = std::max(high, look.high);
  }
  if (plan.ratio > 0)
    plan.frame.budget =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(plan.ratio * static_cast<double>(valid))));
  plan.ratio = 0;
  if (!(high > low)) {  // no tile with an area, or a level one: nothing to refine
    plan.frame.max_error = std::numeric_limits<double>::min();
    return plan;
  }
  plan.frame.max_error = Search(plan.frame.budget, high - low, count).run();
  return plan;
}

}  // namespace retalho
