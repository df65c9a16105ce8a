#include "retalho/visibility/viewshed.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "retalho/core/parallel.h"
#include "retalho/visibility/field_of_view.h"
#include "retalho/visibility/horizon.h"

namespace retalho {
namespace {

using namespace visibility_detail;

/// One octant: where its (u, v) lies on the grid, and how far it reaches.
struct Octant {
  int du_column, du_row, dv_column, dv_row;  // grid steps of u and of v
  int reach_u, reach_v;                      // cells to the border
  bool owns_axis, owns_diagonal;
};

std::array<Octant, 8> octants(const Raster& raster, const Observer& at) {
  std::array<Octant, 8> all{};
  const auto reach = [&](bool column, int sign) {
    if (column) return sign > 0 ? raster.columns - 1 - at.column : at.column;
    return sign > 0 ? raster.rows - 1 - at.row : at.row;
  };
  for (std::size_t i = 0; i < 8; ++i) {
    const bool swap = (i & 4U) != 0;  // u along the rows' axis
    const int su = (i & 1U) != 0 ? -1 : 1, sv = (i & 2U) != 0 ? -1 : 1;
    Octant& o = all[i];
    (swap ? o.du_row : o.du_column) = su;
    (swap ? o.dv_column : o.dv_row) = sv;
    o.reach_u = reach(!swap, su);
    o.reach_v = reach(swap, sv);
    o.owns_axis = sv > 0;
    o.owns_diagonal = !swap;
  }
  return all;
}

/// Distances and limits of one observer's field, in the grid's terms.
class Field {
 public:
  Field(const Raster& raster, const ViewshedOptions& options)
      : width_(raster.cell_width), height_(raster.cell_height), view_(options) {}

  double distance2(int columns, int rows) const {
    const double x = columns * width_, y = rows * height_;
    return x * x + y * y;
  }
  /// How much the Earth's curvature lowers a cell.
  double drop(int columns, int rows) const { return view_.drop() == 0 ? 0 : view_.drop() * distance2(columns, rows); }
  bool holds(int columns, int rows) const { return view_.holds({columns * width_, -rows * height_}); }
  /// Rings beyond this along an axis of that step are out of the radius.
  int rings(int reach, double step) const {
    return view_.radius2() < 0
               ? reach
               : static_cast<int>(std::min<double>(reach, std::floor(std::sqrt(view_.radius2()) / step * (1 + 1e-12))));
  }
  double width() const { return width_; }
  double height() const { return height_; }

 private:
  double width_, height_;
  FieldOfView view_;
};

/// Sweeps one octant and calls sink(column, row, needed): the target height above the ground at which the cell's
/// centre is on the horizon (negative: the ground is above it). Every cell of the octant that is valid and in the
/// field is told once.
template <class Height, class Sink>
void sweep_octant(const Raster& raster, const std::vector<Height>& z, const Observer& observer, const Octant& octant,
                  const Field& field, VoidRule voids, const Context& context, const Sink& sink) {
  const bool along_columns = octant.du_column != 0;
  const int rings = field.rings(octant.reach_u, along_columns ? field.width() : field.height());
  const double eye = static_cast<double>(z[raster.index(observer.column, observer.row)]) + observer.height;
  const double missing = voids == VoidRule::blocks ? kBlocked : kNothing;

  const auto elevation = [&](int k, int j) {  // of the ground at (k, j), lowered by curvature; NaN where void
    const int dc = k * octant.du_column + j * octant.dv_column, dr = k * octant.du_row + j * octant.dv_row;
    return static_cast<double>(z[raster.index(observer.column + dc, observer.row + dr)]) - field.drop(dc, dr) - eye;
  };

  std::vector<Knot> horizon{{0, kNothing, kNothing, kNothing}, {1, kNothing, kNothing, kNothing}}, ring, merged;
  std::vector<std::uint8_t> hidden;  // the interval after cell j is under the horizon
  std::vector<double> before, now;   // ground of the ring before and of this one, height over the eye
  before.push_back(static_cast<double>(z[raster.index(observer.column, observer.row)]) - eye);
  for (int k = 1; k <= rings; ++k) {
    if (k % 64 == 0) context.check();
    const int last = std::min(k, octant.reach_v);
    now.resize(static_cast<std::size_t>(last) + 1);
    for (int j = 0; j <= last; ++j) now[static_cast<std::size_t>(j)] = elevation(k, j);

    // Where the horizon is straight between two cells that both lie under it, so do the edges there: no merging.
    hidden.assign(static_cast<std::size_t>(last) + 1, 0);
    HorizonReader reader(horizon);
    bool under_before = false;
    std::size_t knot_before = 0;
    for (int j = 0; j <= last; ++j) {
      const double over = now[static_cast<std::size_t>(j)];
      const double h = reader.at(static_cast<double>(j) / k);
      const bool under = over < (reader.lowest(static_cast<double>(j) / k, h) - kTieSlope) * k;
      if (under && under_before && reader.position() == knot_before)
        hidden[static_cast<std::size_t>(j) - 1] =
            voids == VoidRule::transparent || (j <= k - 1 && !std::isnan(before[static_cast<std::size_t>(j) - 1]));
      under_before = under;
      knot_before = reader.beyond(static_cast<double>(j) / k);
      if (std::isnan(over) || (j == 0 && !octant.owns_axis) || (j == k && !octant.owns_diagonal)) continue;
      const int dc = k * octant.du_column + j * octant.dv_column, dr = k * octant.du_row + j * octant.dv_row;
      if (field.holds(dc, dr)) sink(observer.column + dc, observer.row + dr, h * k - over, over, k);
    }

    // This ring: its column's edges, and the edges from the ring before where they rise above them.
    ring.clear();
    double right_of_previous = kNothing;  // value that the interval before ends with
    for (int j = 0; j <= last; ++j) {
      const bool hidden_after = hidden[static_cast<std::size_t>(j)] != 0;
      if (hidden_after && j > 0 && hidden[static_cast<std::size_t>(j) - 1] != 0) continue;
      const double s = static_cast<double>(j) / k, over = now[static_cast<std::size_t>(j)];
      const bool valid = !std::isnan(over);
      const double h = over / k;
      Knot knot{s, right_of_previous, valid ? h : missing, kNothing};
      if (!ring.empty() && ring.back().s == s) {  // the cross edge before ended just here (the diagonal)
        knot.left = std::max(knot.left, ring.back().left);
        knot.at = std::max(knot.at, ring.back().at);
        ring.pop_back();
      }
      if (j == last) {
        ring.push_back(knot);
        break;
      }
      if (hidden_after) {
        right_of_previous = kNothing;
        ring.push_back(knot);
        continue;
      }
      const double over_next = now[static_cast<std::size_t>(j) + 1];
      const bool edge = valid && !std::isnan(over_next);
      const double h_next = over_next / k;
      const double column_right = edge ? h : missing, column_end = edge ? h_next : missing;
      const auto crossing = static_cast<std::size_t>(j) < before.size() ? before[static_cast<std::size_t>(j)]
                                                                        : std::numeric_limits<double>::quiet_NaN();
      knot.right = column_right;
      right_of_previous = column_end;
      if (j >= 1 && j <= k - 1) {
        const bool cross_edge = valid && !std::isnan(crossing);
        const double end_s = static_cast<double>(j) / (k - 1);
        const double column_there = edge ? h + (h_next - h) * ((end_s - s) * k) : missing;
        const double cross_start = cross_edge ? h : missing, cross_end = cross_edge ? crossing / (k - 1) : missing;
        if (cross_end > column_there) {
          knot.right = std::max(cross_start, column_right);
          ring.push_back(knot);
          // At its far end the edge is the vertex (k - 1, j): a void edge blocks up to there, not the vertex itself.
          const double vertex = std::isnan(crossing) ? missing : crossing / (k - 1);
          const bool diagonal = j == k - 1;
          ring.push_back({end_s, cross_end, diagonal ? vertex : std::max(vertex, column_there),
                          diagonal ? kNothing : column_there});
          continue;
        }
      }
      ring.push_back(knot);
    }
    merge_horizons(horizon, ring, merged);
    horizon.swap(merged);
    before.swap(now);
  }
}

/// The octants of one observer, each with its own places in the result: they may run at once.
template <class Sink>
void sweep(const Raster& raster, const Observer& observer, const ViewshedOptions& options, const Context& context,
           const Sink& sink) {
  const Field field(raster, options);
  const std::array<Octant, 8> all = octants(raster, observer);
  std::visit(
      [&](const auto& z) {
        parallel_chunks(8, 1, context, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i)
            if (all[i].reach_v > 0 || all[i].owns_axis)
              sweep_octant(raster, z, observer, all[i], field, options.voids, context, sink);
        });
      },
      raster.heights);
}

void check_observer(const CellHeights& cells, const Observer& o) {
  if (!cells.holds(o.column, o.row))
    throw BadInput(fmt::format("the observer's cell ({}, {}) is outside of the grid of {} x {} cells", o.column, o.row,
                               cells.columns, cells.rows));
  if (std::isnan(cells.at(o.column, o.row)))
    throw BadInput(
        fmt::format("the observer's cell ({}, {}) holds no data: move the observer to a valid cell", o.column, o.row));
  if (!std::isfinite(o.height)) throw BadInput("the observer's height is not a number");
}

/// Marks what one observer sees.
template <class Mark>
void mark_visible(const Raster& raster, const Observer& observer, const ViewshedOptions& options,
                  const Context& context, const Mark& mark) {
  check_observer(cells_of(raster), observer);
  const Field field(raster, options);
  const FieldOfView view(options);
  mark(raster.index(observer.column, observer.row));
  sweep(raster, observer, options, context, [&](int column, int row, double needed, double over, int k) {
    if (needed > options.target_height + kTieSlope * k) return;
    const double distance2 = field.distance2(column - observer.column, row - observer.row);
    if (!view.holds_elevation(over + options.target_height, distance2)) return;
    mark(raster.index(column, row));
  });
}

}  // namespace

Observer observer_at(const CellHeights& cells, Vec2 crs, double height) {
  const Vec2 local = cells.georef.to_local(crs);
  const double column = std::floor(local.x / cells.cell_width + 0.5),
               row = std::floor(-local.y / cells.cell_height + 0.5);
  if (!(column >= 0 && row >= 0 && column < cells.columns && row < cells.rows)) {
    const Vec2 a = cells.georef.to_crs(cells.centre(-0.5, cells.rows - 0.5)),
               b = cells.georef.to_crs(cells.centre(cells.columns - 0.5, -0.5));
    throw BadInput(fmt::format("the observer at {}, {} is outside of the grid (x {} to {}, y {} to {})", crs.x, crs.y,
                               a.x, b.x, a.y, b.y));
  }
  const Observer observer{static_cast<int>(column), static_cast<int>(row), height};
  check_observer(cells, observer);
  return observer;
}

Observer observer_at(const Raster& raster, Vec2 crs, double height) {
  return observer_at(cells_of(raster), crs, height);
}

std::vector<std::uint8_t> viewshed(const Raster& raster, const Observer& observer, const ViewshedOptions& options,
                                   const Context& context) {
  std::vector<std::uint8_t> seen(raster.cells(), 0);
  mark_visible(raster, observer, options, context, [&](std::size_t cell) { seen[cell] = 1; });
  return seen;
}

std::vector<std::uint32_t> observer_counts(const Raster& raster, std::span<const Observer> observers,
                                           const ViewshedOptions& options, const Context& context) {
  std::vector<std::uint32_t> counts(raster.cells(), 0);
  for (std::size_t i = 0; i < observers.size(); ++i) {
    mark_visible(raster, observers[i], options, context, [&](std::size_t cell) { ++counts[cell]; });
    context.report("viewsheds", static_cast<double>(i + 1) / static_cast<double>(observers.size()));
  }
  return counts;
}

std::vector<float> needed_heights(const Raster& raster, std::span<const Observer> observers,
                                  const ViewshedOptions& options, const Context& context) {
  std::vector<float> needed(raster.cells(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < observers.size(); ++i) {
    check_observer(cells_of(raster), observers[i]);
    needed[raster.index(observers[i].column, observers[i].row)] = 0;
    sweep(raster, observers[i], options, context, [&](int column, int row, double height, double, int k) {
      if (height > kBlocked / 2) return;
      const float value = height <= kTieSlope * k ? 0.0F : static_cast<float>(height);
      float& cell = needed[raster.index(column, row)];
      if (std::isnan(cell) || value < cell) cell = value;
    });
    context.report("viewsheds", static_cast<double>(i + 1) / static_cast<double>(observers.size()));
  }
  return needed;
}

}  // namespace retalho
