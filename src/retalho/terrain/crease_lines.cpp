#include "retalho/terrain/crease_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/fit_state.h"
#include "retalho/terrain/fit_tolerance.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/tin/breaklines.h"

namespace retalho {
namespace {

using Line = std::vector<Vec3>;

constexpr double kWelded = 1e-3;  // cells: lines so near to each other are one

struct Box {
  Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  void add(Vec2 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  Vec2 nearest(Vec2 p) const { return {std::clamp(p.x, low.x, high.x), std::clamp(p.y, low.y, high.y)}; }
};

Box box_of(const Raster& raster) {
  Box box;
  for (const greedy::Cell c : box_of_valid(raster)) box.add(raster.centre(greedy::column_of(c), greedy::row_of(c)));
  return box;
}

/// The share of a segment inside the box, as Liang and Barsky find it; nothing where from >= to.
std::array<double, 2> inside(const Box& box, Vec2 a, Vec2 b) {
  double from = 0, to = 1;
  const Vec2 d = b - a;
  const auto cut = [&](double step, double room) {  // step * t <= room
    if (step == 0) {
      if (room < 0) to = -1;
    } else if (step > 0) {
      to = std::min(to, room / step);
    } else {
      from = std::max(from, room / step);
    }
  };
  cut(-d.x, a.x - box.low.x);
  cut(d.x, box.high.x - a.x);
  cut(-d.y, a.y - box.low.y);
  cut(d.y, box.high.y - a.y);
  return {from, to};
}

/// The parts of a line inside the box.
std::vector<Line> clipped(const Box& box, const std::vector<Vec2>& line) {
  constexpr double kNoHeight = std::numeric_limits<double>::quiet_NaN();
  std::vector<Line> parts;
  bool open = false;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const bool forward = from_lesser_end(line[k], line[k + 1]);
    const Vec2 a = forward ? line[k] : line[k + 1], b = forward ? line[k + 1] : line[k];
    const auto [from, to] = inside(box, a, b);
    if (!(from < to)) {
      open = false;
      continue;
    }
    const Vec2 lesser = from > 0 ? box.nearest(a + from * (b - a)) : a;
    const Vec2 greater = to < 1 ? box.nearest(a + to * (b - a)) : b;
    const Vec2 start = forward ? lesser : greater, end = forward ? greater : lesser;
    if (!open) parts.push_back({{start.x, start.y, kNoHeight}});
    parts.back().push_back({end.x, end.y, kNoHeight});
    open = forward ? to >= 1 : from <= 0;
  }
  return parts;
}

double distance(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double length2 = norm2(d);
  const double t = length2 > 0 ? std::clamp(dot(p - a, d) / length2, 0.0, 1.0) : 0;
  return norm(p - (a + t * d));
}

/// Points in the cells of a lattice, to be found from segments near them.
class Lattice {
 public:
  Lattice(std::span<const Vec2> points, double size) : points_(points), size_(size) {
    for (std::uint32_t k = 0; k < points.size(); ++k) cells_.push_back({cell(points[k].x), cell(points[k].y), k});
    std::sort(cells_.begin(), cells_.end());
  }
  /// Calls `visit(k)` for the points within `reach`, at most the lattice's size, of a segment; more than once for some.
  template <class Visit>
  void near(Vec2 a, Vec2 b, double reach, const Visit& visit) const {
    const auto steps = static_cast<std::int64_t>(std::ceil(norm(b - a) / size_)) + 1;
    for (std::int64_t s = 0; s <= steps; ++s) {
      const Vec2 p = a + (static_cast<double>(s) / static_cast<double>(steps)) * (b - a);
      for (std::int64_t i = cell(p.x) - 1; i <= cell(p.x) + 1; ++i) {
        const std::array<std::int64_t, 3> first{i, cell(p.y) - 1, -1}, last{i, cell(p.y) + 2, -1};
        const auto end = std::lower_bound(cells_.begin(), cells_.end(), last);
        for (auto at = std::lower_bound(cells_.begin(), cells_.end(), first); at != end; ++at)
          if (const auto k = static_cast<std::size_t>((*at)[2]); distance(points_[k], a, b) < reach) visit(k);
      }
    }
  }

 private:
  std::int64_t cell(double v) const { return static_cast<std::int64_t>(std::floor(v / size_)); }

  std::span<const Vec2> points_;
  double size_;
  std::vector<std::array<std::int64_t, 3>> cells_;
};

Vec2 plan(const Vec3& p) {
  return {p.x, p.y};
}

/// Moves places within `reach` of each other together, of each group to the least in the order of x, then y.
void weld_places(std::vector<Line>& lines, double reach, double spacing) {
  std::vector<Vec2> places;
  for (const Line& line : lines)
    for (const Vec3& p : line) places.push_back(plan(p));
  std::vector<std::uint32_t> order(places.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    return places[i].x != places[j].x ? places[i].x < places[j].x : places[i].y < places[j].y;
  });
  const Lattice lattice(places, spacing);
  std::vector<Vec2> moved = places;
  std::vector<char> settled(places.size());
  for (const std::uint32_t k : order) {
    if (settled[k] != 0) continue;
    lattice.near(places[k], places[k], reach, [&](std::size_t other) {
      if (settled[other] == 0) moved[other] = places[k];
      settled[other] = 1;
    });
  }
  std::size_t k = 0;
  for (Line& line : lines) {
    for (Vec3& p : line) {
      p.x = moved[k].x;
      p.y = moved[k++].y;
    }
    line.erase(std::unique(line.begin(), line.end(), [](const Vec3& p, const Vec3& q) { return plan(p) == plan(q); }),
               line.end());
  }
}

/// Lines that run over each other become one there: places within `reach` are moved together, and a place so near to a
/// segment becomes a vertex of it. Rounding and the surveyor's hand put slanting lines beside each other by less than
/// that, and needles between them would have any slope.
void weld(std::vector<Line>& lines, double reach, double spacing) {
  weld_places(lines, reach, spacing);
  std::vector<Vec2> places;
  for (const Line& line : lines)
    for (const Vec3& p : line) places.push_back(plan(p));
  const Lattice lattice(places, spacing);
  for (Line& line : lines) {
    Line whole;
    for (std::size_t k = 0; k < line.size(); ++k) {
      whole.push_back(line[k]);
      if (k + 1 == line.size()) break;
      const Vec2 a = plan(line[k]), d = plan(line[k + 1]) - a;
      std::vector<std::pair<double, Vec2>> between;
      lattice.near(a, a + d, reach, [&](std::size_t other) {
        const Vec2 p = places[other];
        if (!(p == a) && !(p == plan(line[k + 1]))) between.emplace_back(dot(p - a, d), p);
      });
      std::sort(between.begin(), between.end(), [](const auto& p, const auto& q) {
        return std::tie(p.first, p.second.x, p.second.y) < std::tie(q.first, q.second.x, q.second.y);
      });
      for (const auto& [along, p] : between)
        if (!(p == plan(whole.back()))) whole.push_back({p.x, p.y, line[k].z});
    }
    line = std::move(whole);
  }
}

std::size_t count_places(const std::vector<Line>& lines) {
  std::vector<std::pair<double, double>> places;
  for (const Line& line : lines)
    for (const Vec3& p : line) places.emplace_back(p.x, p.y);
  std::sort(places.begin(), places.end());
  return static_cast<std::size_t>(std::unique(places.begin(), places.end()) - places.begin());
}

/// The vertices of `base` without those within `reach` of a line, and the lines, which lie on `base`.
ConstrainedTin among_lines(const Terrain& base, std::vector<Line>& lines, const Box& box, double reach,
                           const Context& context) {
  const TerrainEvaluator surface(base, context);
  const Lattice lattice(base.tin.points, reach);
  std::vector<char> near(base.tin.vertex_count());
  for (Line& line : lines)
    for (std::size_t k = 0; k < line.size(); ++k) {
      line[k].z = surface.value(plan(line[k]));
      if (k > 0) lattice.near(plan(line[k - 1]), plan(line[k]), reach, [&](std::size_t v) { near[v] = 1; });
    }
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < base.tin.vertex_count(); ++v) {
    const Vec2 p = base.tin.points[v];
    const bool corner = (p.x == box.low.x || p.x == box.high.x) && (p.y == box.low.y || p.y == box.high.y);
    if (corner || near[v] == 0) points.push_back({p.x, p.y, base.tin.heights[v]});
  }
  return triangulate_points(points, lines, nullptr, nullptr, context);
}

}  // namespace

Terrain refine_along_lines(const Raster& raster, std::span<const std::vector<Vec2>> given,
                           const SurfaceRefineOptions& options, CreaseLineNotes* notes, const Context& context) {
  if (options.max_error > 0 || options.vertices == 0)
    throw UsageError("a surface along lines takes a budget of vertices, and no largest error", {}, "vertices");
  if (options.surface == SurfaceKind::linear)
    throw UsageError("lines to fold along are for smooth surfaces: a flat one folds along every edge", {}, "surface");
  const Box box = box_of(raster);
  const Vec2 extent = box.high - box.low;
  const double cell = std::sqrt(raster.cell_width * raster.cell_height);
  const double spacing = std::max(cell, std::sqrt(extent.x * extent.y / static_cast<double>(options.vertices)));
  std::vector<Line> lines;
  for (const std::vector<Vec2>& line : given)
    for (Line& part : clipped(box, line)) lines.push_back(std::move(part));
  weld(lines, kWelded * cell, spacing);
  for (Line& line : lines) line = with_steps(line, spacing);
  const std::size_t on_lines = count_places(lines);
  if (lines.empty()) throw BadInput("none of the lines to fold along is inside the grid");
  if (on_lines + 4 > options.vertices)
    throw UsageError(fmt::format("the lines to fold along need {} vertices of a budget of {}: give more", on_lines,
                                 options.vertices),
                     {}, "vertices");
  // Vertices near the lines give way to them, and lines that cross get more: the rest of the budget is asked for again.
  constexpr int kRounds = 4;
  SurfaceRefineOptions elsewhere = options;
  elsewhere.vertices -= on_lines;
  elsewhere.creases = elsewhere.heights_only = false;
  ConstrainedTin made;
  for (int round = 0; round < kRounds; ++round) {
    ConstrainedTin tin = among_lines(refine_surface(raster, elsewhere, context), lines, box, cell / 2, context);
    const std::size_t count = tin.tin.vertex_count();
    if (count <= options.vertices && count > made.tin.vertex_count()) made = std::move(tin);
    if (count <= options.vertices && options.vertices - count <= options.vertices / 50) break;
    const std::size_t next = elsewhere.vertices + options.vertices;
    if (next < count + 4) break;
    elsewhere.vertices = next - count;
  }
  if (made.tin.triangles.empty())
    throw UsageError(fmt::format("the lines to fold along and their crossings need more than the budget of {} vertices",
                                 options.vertices),
                     {}, "vertices");
  if (notes) *notes = {lines.size(), on_lines, made.edges.size()};
  SurfaceOptions how{.surface = options.surface, .creases = std::move(made.edges)};
  return fit_least_squares(make_terrain(std::move(made.tin), raster, how, context), raster,
                           {.slope_weight = options.slope_weight,
                            .fairness = options.fairness,
                            .tolerance = kFinalSolve.tolerance,
                            .iterations = kFinalSolve.iterations},
                           context);
}

}  // namespace retalho
