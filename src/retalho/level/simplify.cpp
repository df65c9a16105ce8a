#include "retalho/level/simplify.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "retalho/core/parallel.h"
#include "retalho/core/variants.h"
#include "retalho/level/fixed_pieces.h"
#include "retalho/level/line_thinner.h"

namespace retalho {
namespace {

constexpr int kHalvings = 4;

class GridSurface {
 public:
  explicit GridSurface(const FixedGrid& grid) : grid_(grid) {}

  RETALHO_TWO_VARIANTS bool across(const Strip& strip, std::uint32_t, double& steepest) {
    // In cells, y to the south.
    const double w = grid_.cell_width, h = grid_.cell_height;
    const Vec2 end = strip.start + strip.length * strip.along;
    const double margin = std::max(-strip.low, strip.high);
    const double top = (-std::max(strip.start.y, end.y) - margin) / h,
                 bottom = (-std::min(strip.start.y, end.y) + margin) / h;
    const int first = std::max(0, static_cast<int>(std::floor(top)));
    const int last = std::min(grid_.rows - 2, static_cast<int>(std::floor(bottom)));
    for (int row = first; row <= last; ++row) {
      // The part of the chord whose strip may reach this row.
      double s0 = 0, s1 = strip.length;
      if (std::abs(strip.along.y) > 1e-9) {
        double a = (-row * h + margin - strip.start.y) / strip.along.y;
        double b = (-(row + 1) * h - margin - strip.start.y) / strip.along.y;
        if (a > b) std::swap(a, b);
        s0 = std::max(s0, a);
        s1 = std::min(s1, b);
      }
      if (s0 > s1) continue;
      const double x0 = strip.start.x + s0 * strip.along.x, x1 = strip.start.x + s1 * strip.along.x;
      const int left = std::max(0, static_cast<int>(std::floor((std::min(x0, x1) - margin) / w)));
      const int right = std::min(grid_.columns - 2, static_cast<int>(std::floor((std::max(x0, x1) + margin) / w)));
      for (int column = left; column <= right; ++column) {
        const Frame frame = grid_.frame(column, row);
        if (!strip.touches(frame_corners<RectanglePatch>(frame))) continue;
        if (!grid_.has_patch(column, row)) return false;
        const Seen& seen = slopes(column, row, frame);
        if (seen.sector.across(strip))
          steepest = std::max(steepest, seen.sector.longest);
        else if (!grows_across(seen.slopes, frame, strip, kHalvings, 1, steepest))
          return false;
      }
    }
    return true;
  }

 private:
  struct Seen {
    std::size_t node = static_cast<std::size_t>(-1);
    SlopeSector sector;
    PatchSlopes<RectanglePatch> slopes;
  };
  /// Of the patches seen last, by a few bits of their place: a line's chords ask for the same ones again and again.
  [[gnu::always_inline]] const Seen& slopes(int column, int row, const Frame& frame) {
    const std::size_t node = grid_.node(column, row);
    Seen& seen = seen_[(static_cast<std::size_t>(row) % 16) * 16 + static_cast<std::size_t>(column) % 16];
    if (seen.node != node) {
      seen.node = node;
      seen.slopes = PatchSlopes<RectanglePatch>(grid_.net(column, row));
      seen.sector = SlopeSector(seen.slopes, frame);
    }
    return seen;
  }

  const FixedGrid& grid_;
  std::vector<Seen> seen_ = std::vector<Seen>(256);
};

/// Is the triangulated area convex: one border, turning left throughout?
bool convex_border(const Tin& tin) {
  std::vector<std::uint32_t> next(tin.points.size(), kNone);
  std::size_t edges = 0;
  std::uint32_t start = kNone;
  for (std::size_t t = 0; t < tin.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (tin.neighbors[t][k] != kNone) continue;
      const std::uint32_t a = tin.triangles[t][(k + 1) % 3], b = tin.triangles[t][(k + 2) % 3];
      if (next[a] != kNone) return false;
      next[a] = b;
      start = a;
      ++edges;
    }
  if (start == kNone) return false;
  std::size_t walked = 0;
  std::uint32_t a = start;
  do {
    const std::uint32_t b = next[a];
    if (b == kNone || next[b] == kNone) return false;
    if (cross(tin.points[b] - tin.points[a], tin.points[next[b]] - tin.points[b]) < 0) return false;
    a = b;
    ++walked;
  } while (a != start && walked <= edges);
  return walked == edges;
}

template <SurfaceKind Kind>
class TinSurface {
 public:
  using Pieces = FixedPieces<Kind>;
  using Patch = typename Pieces::Patch;

  TinSurface(const Terrain& terrain, const EdgeTable& edges, double per_unit, bool convex)
      : terrain_(terrain),
        edges_(edges),
        per_unit_(per_unit),
        convex_(convex),
        seen_(terrain.tin.triangle_count(), 0) {}

  /// Floods from triangle `hint` over all triangles that the strip touches.
  bool across(const Strip& strip, std::uint32_t hint, double& steepest) {
    const Tin& tin = terrain_.tin;
    ++round_;
    stack_.assign(1, hint);
    seen_[hint] = round_;
    while (!stack_.empty()) {
      const std::uint32_t t = stack_.back();
      stack_.pop_back();
      const Pieces pieces(terrain_, edges_, t, per_unit_);
      for (std::size_t p = 0; p < pieces.nets.size(); ++p) {
        if (!strip.touches(frame_corners<Patch>(pieces.frames[p]))) continue;
        if (!grows_across(PatchSlopes<Patch>(pieces.nets[p]), pieces.frames[p], strip, kHalvings, 1, steepest))
          return false;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t neighbor = tin.neighbors[t][k];
        const Vec2 a = tin.points[tin.triangles[t][(k + 1) % 3]], b = tin.points[tin.triangles[t][(k + 2) % 3]];
        if (neighbor == kNone) {
          if (!convex_ && strip.touches(std::array<Vec2, 2>{a, b})) return false;
          continue;
        }
        if (seen_[neighbor] == round_ || !strip.touches(std::array<Vec2, 2>{a, b})) continue;
        seen_[neighbor] = round_;
        stack_.push_back(neighbor);
      }
    }
    return true;
  }

 private:
  const Terrain& terrain_;
  const EdgeTable& edges_;
  double per_unit_;
  bool convex_;
  std::vector<std::uint32_t> seen_, stack_;
  std::uint32_t round_ = 0;
};

template <class MakeSurface>
void simplify(RawLines& lines, const FixedLevels& levels, const Context& context, const MakeSurface& make_surface) {
  ContourSet& set = lines.set;
  std::vector<std::uint8_t> keep(set.points.size(), 0);
  constexpr std::size_t kGrain = 256;
  parallel_chunks(set.lines.size(), kGrain, context, [&](std::size_t from, std::size_t to) {
    auto surface = make_surface();
    LineThinner thinner(surface, set.tolerance, lines.raw);
    for (std::size_t l = from; l < to; ++l) {
      const ContourLine& line = set.lines[l];
      const std::size_t n = line.end - line.begin;
      std::span<const std::uint32_t> cells;
      if (!lines.cell.empty()) cells = std::span(lines.cell).subspan(line.begin, n);
      thinner.thin(std::span(set.points).subspan(line.begin, n), cells, line.closed, 2 * levels.tube(line.level),
                   std::span(keep).subspan(line.begin, n));
    }
  });
  std::size_t write = 0;
  for (ContourLine& line : set.lines) {
    const std::size_t begin = write;
    for (std::size_t i = line.begin; i < line.end; ++i)
      if (keep[i] != 0) set.points[write++] = set.points[i];
    line.begin = begin;
    line.end = write;
  }
  set.points.resize(write);
}

template <SurfaceKind Kind>
void simplify_kind(RawLines& lines, const Terrain& terrain, const EdgeTable& edges, double per_unit,
                   const FixedLevels& levels, const Context& context, bool part) {
  const bool convex = !part && convex_border(terrain.tin);
  simplify(lines, levels, context, [&] { return TinSurface<Kind>(terrain, edges, per_unit, convex); });
}

}  // namespace

void simplify_lines(RawLines& lines, const FixedGrid& grid, const FixedLevels& levels, const Context& context) {
  simplify(lines, levels, context, [&] { return GridSurface(grid); });
}

void simplify_lines(RawLines& lines, const Terrain& terrain, const EdgeTable& edges, double per_unit,
                    const FixedLevels& levels, const Context& context, bool part) {
  switch (terrain.kind) {
    case SurfaceKind::powell_sabin:
      return simplify_kind<SurfaceKind::powell_sabin>(lines, terrain, edges, per_unit, levels, context, part);
    case SurfaceKind::clough_tocher:
      return simplify_kind<SurfaceKind::clough_tocher>(lines, terrain, edges, per_unit, levels, context, part);
    case SurfaceKind::linear:
      return simplify_kind<SurfaceKind::linear>(lines, terrain, edges, per_unit, levels, context, part);
  }
}

}  // namespace retalho
