#include "retalho/visibility/surface_viewshed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/visibility/field_of_view.h"
#include "retalho/visibility/surface_sight.h"

namespace retalho {
namespace {

using namespace visibility_detail;

/// The surface's height at `at`. Throws BadInput where there is none.
double ground_at(const TerrainEvaluator& evaluator, Vec2 at, const char* what) {
  const double z = evaluator.value(at);
  if (std::isnan(z)) {
    const Vec2 crs = evaluator.terrain().georef.to_crs(at);
    throw BadInput(fmt::format("the model has no data at the {} {}, {}: move it to where it has", what, crs.x, crs.y));
  }
  return z;
}

double eye_of(const TerrainEvaluator& evaluator, const SurfaceObserver& observer) {
  if (!std::isfinite(observer.height) || observer.height < 0)
    throw BadInput(fmt::format("the observer's height {} is not a height above the surface", observer.height));
  return ground_at(evaluator, observer.at, "observer") + observer.height;
}

/// Calls visit(cell, sight, field, target, offset, ground) for all cells in the field of one observer, threads sharing
/// the rows; ground is the target's height over the eye, lowered by curvature.
template <class Visit>
void each_target(const SegmentWalk& walk, const Raster& cells, const SurfaceObserver& observer,
                 const ViewshedOptions& options, const Context& context, const Visit& visit) {
  const double eye = eye_of(walk.evaluator(), observer);
  const FieldOfView view(options);
  const SurfaceSight sight(walk, observer.at, eye, view.drop(), options.voids);
  parallel_chunks(static_cast<std::size_t>(cells.rows), 1, context, [&](std::size_t first, std::size_t last) {
    for (auto row = static_cast<int>(first); row < static_cast<int>(last); ++row)
      for (int column = 0; column < cells.columns; ++column) {
        const std::size_t cell = cells.index(column, row);
        const double height = cells.at(cell);
        if (std::isnan(height)) continue;
        const Vec2 target = cells.centre(column, row);
        const Vec2 offset = target - observer.at;
        const double distance2 = dot(offset, offset);
        if (distance2 > 0 && !view.holds(offset)) continue;
        visit(cell, sight, view, target, distance2, height - view.drop() * distance2 - eye);
      }
  });
}

}  // namespace

std::vector<std::uint32_t> surface_observer_counts(const TerrainEvaluator& evaluator,
                                                   std::span<const SurfaceObserver> observers,
                                                   const ViewshedOptions& options, const Context& context) {
  const Raster cells = raster_of_cells(evaluator, context);
  const SegmentWalk walk(evaluator, context);
  std::vector<std::uint32_t> counts(cells.cells(), 0);
  for (std::size_t i = 0; i < observers.size(); ++i) {
    each_target(walk, cells, observers[i], options, context,
                [&](std::size_t cell, const SurfaceSight& sight, const FieldOfView& view, Vec2 target, double distance2,
                    double ground) {
                  const double aim = ground + options.target_height;
                  if (distance2 > 0 && !view.holds_elevation(aim, distance2)) return;
                  if (distance2 == 0 || sight.raise(target, aim, aim) <= aim) ++counts[cell];
                });
    context.report("viewsheds", static_cast<double>(i + 1) / static_cast<double>(observers.size()));
  }
  return counts;
}

std::vector<float> surface_needed_heights(const TerrainEvaluator& evaluator, std::span<const SurfaceObserver> observers,
                                          const ViewshedOptions& options, const Context& context) {
  const Raster cells = raster_of_cells(evaluator, context);
  const SegmentWalk walk(evaluator, context);
  constexpr double none = std::numeric_limits<double>::infinity();
  std::vector<float> needed(cells.cells(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < observers.size(); ++i) {
    each_target(walk, cells, observers[i], options, context,
                [&](std::size_t cell, const SurfaceSight& sight, const FieldOfView&, Vec2 target, double distance2,
                    double ground) {
                  const double slope = distance2 == 0 ? ground : sight.raise(target, ground, none);
                  if (slope == none) return;
                  const auto value = static_cast<float>(slope - ground);
                  if (std::isnan(needed[cell]) || value < needed[cell]) needed[cell] = value;
                });
    context.report("viewsheds", static_cast<double>(i + 1) / static_cast<double>(observers.size()));
  }
  return needed;
}

SightLine surface_line_of_sight(const TerrainEvaluator& evaluator, const SurfaceObserver& observer, Vec2 target,
                                const SightOptions& options) {
  const double eye = eye_of(evaluator, observer), drop = curvature_drop(options.earth_curvature, options.refraction);
  const Vec2 way = target - observer.at;
  const double length2 = dot(way, way), length = std::sqrt(length2);
  const double aim = ground_at(evaluator, target, "target") - drop * length2 + options.target_height - eye;
  const SegmentWalk walk(evaluator);
  const SurfaceSight sight(walk, observer.at, eye, drop, options.voids);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  SightLine line;
  line.clearance = std::numeric_limits<double>::infinity();
  line.fresnel_clear = options.frequency > 0 ? line.clearance : nan;
  line.blocked_at = nan;
  line.visible = length == 0 || sight.raise(target, aim, aim) <= aim;
  const auto add = [&](double t, double over_eye) {
    ProfilePoint p;
    p.distance = t * length;
    p.at = observer.at + t * way;
    p.ground = over_eye + eye;
    p.sight = eye + t * aim;
    p.fresnel = fresnel_radius(options.frequency, p.distance, length);
    if (p.fresnel > 0) line.fresnel_clear = std::min(line.fresnel_clear, (p.sight - p.ground) / p.fresnel);
    line.profile.push_back(p);
  };
  if (length == 0) {
    add(0, aim - options.target_height);
    line.clearance = 0;
    return line;
  }
  const bool masked = !evaluator.terrain().grid.valid.empty();
  double reached = 0;
  sight.pieces(target, [&](double begin, double end, const Cubic& c) {
    const double size = end - begin;
    const auto free = [&](double u) { return aim * (begin + u * size) - cubic_part(c, u, u)[0]; };
    // A stretch without data between the piece before and this one.
    if (masked && begin > reached + 1e-12) add(0.5 * (reached + begin), nan);
    reached = end;
    for (const double u : {0.0, 0.25, 0.5, 0.75}) add(begin + u * size, aim * (begin + u * size) - free(u));
    // The clearance is smallest at an end or where its slope, a quadratic, is zero.
    const double a = aim * size - 3 * (c[1] - c[0]), b = aim * size - 3 * (c[2] - c[1]),
                 d = aim * size - 3 * (c[3] - c[2]);
    std::vector<double> places{0, 1};
    const double p = a - 2 * b + d, q = b - a, root = std::sqrt(std::max(0.0, q * q - p * a));
    if (q * q >= p * a) {  // p u^2 + 2 q u + a = 0
      const double s = -(q + (q < 0 ? -root : root));
      for (const double u : {p == 0 ? -1 : s / p, s == 0 ? -1 : a / s})
        if (u > 0 && u < 1) places.push_back(u);
    }
    std::sort(places.begin(), places.end());
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double here = free(places[k]);
      line.clearance = std::min(line.clearance, here);
      if (here >= -sight.touch() || !std::isnan(line.blocked_at)) continue;
      // It went under between the place before and this one, where it only falls.
      double low = k == 0 ? 0 : places[k - 1], high = places[k];
      for (int step = 0; step < 60 && k > 0; ++step) {
        const double middle = 0.5 * (low + high);
        (free(middle) < -sight.touch() ? high : low) = middle;
      }
      line.blocked_at = (begin + high * size) * length;
    }
  });
  add(1, aim - options.target_height);
  if (line.visible) line.blocked_at = nan;
  return line;
}

}  // namespace retalho
