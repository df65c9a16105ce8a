#include "retalho/level/conics.h"

#include <array>
#include <span>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/level/clip.h"
#include "retalho/level/conic_cut.h"
#include "retalho/level/contour.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/lines.h"
#include "retalho/level/trace_terrain.h"

namespace retalho {

ConicSet trace_conics(const Terrain& terrain, std::vector<double> levels, const Context& context) {
  check_levels(levels);
  if (terrain.kind == SurfaceKind::clough_tocher)
    throw BadInput("level lines of a Clough-Tocher surface are cubics, not conics: take a Powell-Sabin surface");
  const EdgeTable edges = build_edges(terrain.tin);
  const double per_unit = terrain_quanta(terrain, edges, context);
  const FixedLevels fixed(levels, per_unit);
  OuterRoots outer;
  const Trace trace =
      trace_terrain(terrain, edges, per_unit, fixed, 1, outer, context, terrain.kind == SurfaceKind::powell_sabin);
  ConicSet set;
  set.levels = std::move(levels);
  set.height_quantum = 1 / per_unit;
  const auto lift = [](Vec2 p) { return Vec3{p.x, p.y, 0}; };
  const TracedLines traced = find_lines(trace);
  for (const TracedLine& line : traced.lines) {
    context.check();
    ConicLine out{line.level, {}};
    out.curve.closed = line.closed;
    const std::uint32_t links = line.closed ? line.count : line.count - 1;
    for (const std::uint32_t p : std::span(traced.order).subspan(line.first, links)) {
      const Vec2 a = trace.points[p], b = trace.points[trace.next[p]];
      if (a == b) continue;
      ConicLink link = trace.keep_conics ? trace.conics[p] : ConicLink{};
      if (link.weight == 0) link = {0.5 * (a + b), 1};
      out.curve.append(std::array{lift(a), lift(link.control), lift(b)}, 1, std::array{1.0, link.weight, 1.0});
    }
    if (!out.curve.empty()) set.lines.push_back(std::move(out));
  }
  if (has_voids(terrain.grid)) set.lines = cut_conics(std::move(set.lines), terrain.grid, context);
  return set;
}

void move_to_crs(ConicSet& set, const Georef& georef) {
  for (ConicLine& line : set.lines)
    for (Vec3& p : line.curve.points) {
      const Vec2 place = georef.to_crs({p.x, p.y});
      p = {place.x, place.y, 0};
    }
}

}  // namespace retalho
