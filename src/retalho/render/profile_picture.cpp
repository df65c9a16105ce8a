#include "retalho/render/profile_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/core/error.h"

namespace retalho {
namespace {

// Colours that also differ in lightness, for eyes that do not tell red from green.
constexpr Rgb kGround{120, 84, 48}, kSoil{226, 213, 194}, kSight{0, 90, 160}, kZone{205, 225, 243},
    kBlocked{200, 30, 30};

void to(PlanePath& path, Vec2 p) {
  path.verbs.push_back(path.verbs.empty() || path.verbs.back() == PathVerb::close ? PathVerb::move : PathVerb::line);
  path.points.push_back(p);
}

}  // namespace

CurvePicture profile_picture(const SightLine& line, const std::string& unit) {
  if (line.profile.size() < 2 || !(line.profile.back().distance > 0))
    throw UsageError("the sight line has no length: give --to another place than the observer's", {}, "--to");
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ProfilePoint& p : line.profile) {
    for (const double h : {p.ground, p.sight - p.fresnel, p.sight + p.fresnel})
      if (std::isfinite(h)) {
        low = std::min(low, h);
        high = std::max(high, h);
      }
  }
  const double length = line.profile.back().distance, height = high > low ? high - low : 1;
  PicturePanel panel;
  panel.axes = true;
  panel.stretch = true;
  panel.low = {-0.02 * length, low - 0.1 * height};
  panel.high = {1.02 * length, high + 0.18 * height};

  PlanePath zone, soil, ground;
  for (const ProfilePoint& p : line.profile) to(zone, {p.distance, p.sight + p.fresnel});
  for (auto p = line.profile.rbegin(); p != line.profile.rend(); ++p) to(zone, {p->distance, p->sight - p->fresnel});
  zone.verbs.push_back(PathVerb::close);
  bool open = false;
  double reached = 0;
  const auto close_soil = [&] {
    if (!open) return;
    to(soil, {reached, panel.low.y});
    soil.verbs.push_back(PathVerb::close);
    open = false;
  };
  for (const ProfilePoint& p : line.profile) {
    if (!std::isfinite(p.ground)) {
      close_soil();
      continue;
    }
    if (!open) to(soil, {p.distance, panel.low.y});
    ground.verbs.push_back(open ? PathVerb::line : PathVerb::move);
    ground.points.push_back({p.distance, p.ground});
    to(soil, {p.distance, p.ground});
    open = true;
    reached = p.distance;
  }
  close_soil();
  PlanePath sight;
  to(sight, {0, line.profile.front().sight});
  to(sight, {length, line.profile.back().sight});

  const bool fresnel = line.profile[line.profile.size() / 2].fresnel > 0;
  if (fresnel) panel.paths.push_back({zone, {kZone, 1, false, true}, true});
  panel.paths.push_back({soil, {kSoil, 1, false, true}, true});
  panel.paths.push_back({ground, {kGround, 1.6, false, false}, false});
  panel.paths.push_back({sight, {kSight, 1.4, false, false}, false});
  panel.dots.push_back({sight.points[0], 4, kSight, false});
  panel.dots.push_back({sight.points[1], 4, kSight, !line.visible});
  if (!line.visible && std::isfinite(line.blocked_at)) {
    const double t = line.blocked_at / length;
    const Vec2 at = (1 - t) * sight.points[0] + t * sight.points[1];
    panel.dots.push_back({at, 4.5, kBlocked, false});
    // Written over the terrain, with a line down to the place.
    const Vec2 over{at.x, high + 0.08 * height};
    panel.paths.push_back({{{PathVerb::move, PathVerb::line}, {at, over}}, {kBlocked, 1, true, false}, true});
    panel.labels.push_back({over, fmt::format("blocked at {:.6g}", line.blocked_at), kBlocked});
  }
  panel.title = line.visible ? fmt::format("visible over {:.6g} {}, clearance {:.4g}", length, unit, line.clearance)
                             : fmt::format("not visible over {:.6g} {}", length, unit);
  if (fresnel)
    panel.title += fmt::format(", first Fresnel zone {:.0f} % clear", 100 * std::clamp(line.fresnel_clear, 0.0, 1.0));
  CurvePicture picture;
  picture.panel_width = 900;
  picture.panel_height = 360;
  picture.panels.push_back(std::move(panel));
  return picture;
}

}  // namespace retalho
