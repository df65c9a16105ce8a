#include "retalho/tin/breaklines.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/tin/constraint_mesh.h"
#include "retalho/tin/predicates.h"

namespace retalho {
namespace {

using Line = std::vector<Vec3>;

Vec2 plan(const Vec3& p) {
  return {p.x, p.y};
}

/// The lines without repeated places; lines of one place are left out (they stay points).
std::vector<Line> tidy(std::span<const Line> given) {
  std::vector<Line> lines;
  for (std::size_t n = 0; n < given.size(); ++n) {
    Line line;
    for (std::size_t k = 0; k < given[n].size(); ++k) {
      const Vec3& p = given[n][k];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || std::isinf(p.z))
        throw BadInput(fmt::format("vertex {} of breakline {} is not finite: ({}, {}, {})", k, n, p.x, p.y, p.z));
      if (line.empty() || !(plan(line.back()) == plan(p))) line.push_back(p);
    }
    if (!line.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

/// Height of the flat surface at p, walking from triangle `t`, which is left where p lies.
std::optional<double> flat_height(const Tin& tin, Vec2 p, std::uint32_t& t) {
  for (std::size_t step = 0; step <= 4 * tin.triangles.size(); ++step) {
    const auto& v = tin.triangles[t];
    std::size_t out = 3;
    for (std::size_t k = 0; k < 3 && out == 3; ++k)
      if (orientation(tin.points[v[(k + 1) % 3]], tin.points[v[(k + 2) % 3]], p) < 0) out = k;
    if (out == 3) {
      const Vec2 a = tin.points[v[0]], b = tin.points[v[1]], c = tin.points[v[2]];
      const double area2 = cross(b - a, c - a), s = cross(p - a, c - a) / area2, r = cross(b - a, p - a) / area2;
      return tin.heights[v[0]] + s * (tin.heights[v[1]] - tin.heights[v[0]]) +
             r * (tin.heights[v[2]] - tin.heights[v[0]]);
    }
    t = tin.neighbors[t][out];
    if (t == kNone) return std::nullopt;
  }
  return std::nullopt;
}

void drape(std::vector<Line>& lines, std::span<const Vec3> points, BreaklineNotes& notes, const Context& context) {
  std::optional<Tin> tin;
  std::uint32_t at = 0;
  for (std::size_t n = 0; n < lines.size(); ++n)
    for (Vec3& p : lines[n]) {
      if (!std::isnan(p.z)) continue;
      if (!tin) tin = triangulate_points(points, nullptr, context);
      const auto z = flat_height(*tin, plan(p), at);
      if (!z)
        throw BadInput(fmt::format(
            "breakline {} has a vertex without height at {}, {}, outside the points: give the lines heights (z)", n,
            p.x, p.y));
      p.z = *z;
      ++notes.draped;
    }
}

struct Segment {
  std::uint32_t line, index;  ///< from vertex `index` to the next
  double low_x, high_x, low_y, high_y;
};

struct Cut {
  std::uint32_t line, index;
  double fraction;
  Vec3 at;
};

std::vector<Segment> segments_by_x(const std::vector<Line>& lines) {
  std::vector<Segment> all;
  for (std::uint32_t n = 0; n < lines.size(); ++n)
    for (std::uint32_t k = 0; k + 1 < lines[n].size(); ++k) {
      const Vec3 &a = lines[n][k], &b = lines[n][k + 1];
      all.push_back({n, k, std::min(a.x, b.x), std::max(a.x, b.x), std::min(a.y, b.y), std::max(a.y, b.y)});
    }
  std::sort(all.begin(), all.end(), [](const Segment& s, const Segment& t) { return s.low_x < t.low_x; });
  return all;
}

/// Where two segments cross strictly between their ends.
bool cross_between(const std::vector<Line>& lines, const Segment& s, const Segment& t) {
  const Vec2 a = plan(lines[s.line][s.index]), b = plan(lines[s.line][s.index + 1]);
  const Vec2 c = plan(lines[t.line][t.index]), d = plan(lines[t.line][t.index + 1]);
  return orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0;
}

/// All crossings by a sweep over x.
std::vector<Cut> find_cuts(const std::vector<Line>& lines, BreaklineNotes& notes, const Context& context) {
  const std::vector<Segment> segments = segments_by_x(lines);
  std::vector<Cut> cuts;
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    if (i % 4096 == 0) context.check();
    const Segment& s = segments[i];
    std::erase_if(open, [&](std::uint32_t k) { return segments[k].high_x < s.low_x; });
    for (const std::uint32_t k : open) {
      const Segment& t = segments[k];
      if (t.high_y < s.low_y || s.high_y < t.low_y || !cross_between(lines, s, t)) continue;
      const Vec3 &a = lines[s.line][s.index], &b = lines[s.line][s.index + 1];
      const Vec3 &c = lines[t.line][t.index], &d = lines[t.line][t.index + 1];
      const Vec2 u = plan(b) - plan(a), v = plan(d) - plan(c), w = plan(c) - plan(a);
      const double f = cross(w, v) / cross(u, v), g = cross(w, u) / cross(u, v);
      const double z_s = a.z + f * (b.z - a.z), z_t = c.z + g * (d.z - c.z);
      const Vec2 at = plan(a) + f * u;
      notes.largest_disagreement = std::max(notes.largest_disagreement, std::abs(z_s - z_t));
      ++notes.crossings;
      const Vec3 both{at.x, at.y, (z_s + z_t) / 2};
      cuts.push_back({s.line, s.index, f, both});
      cuts.push_back({t.line, t.index, g, both});
    }
    open.push_back(i);
  }
  return cuts;
}

void cut_lines(std::vector<Line>& lines, std::vector<Cut> cuts) {
  std::sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) {
    return a.line != b.line ? a.line < b.line : a.index != b.index ? a.index < b.index : a.fraction < b.fraction;
  });
  for (std::size_t from = 0; from < cuts.size();) {
    const std::uint32_t n = cuts[from].line;
    Line line;
    std::size_t next = from;
    for (std::uint32_t k = 0; k < lines[n].size(); ++k) {
      line.push_back(lines[n][k]);
      for (; next < cuts.size() && cuts[next].line == n && cuts[next].index == k; ++next)
        if (!(plan(line.back()) == plan(cuts[next].at))) line.push_back(cuts[next].at);
    }
    lines[n] = std::move(line);
    from = next;
  }
}

void split_crossings(std::vector<Line>& lines, BreaklineNotes& notes, const Context& context) {
  // Rounding a crossing moves the lines by an ulp, which can make new crossings: again until there are none.
  for (int round = 0; round < 8; ++round) {
    std::vector<Cut> cuts = find_cuts(lines, notes, context);
    if (cuts.empty()) return;
    cut_lines(lines, std::move(cuts));
  }
  throw BadInput("the breaklines cross so often at so small angles that doubles cannot tell their crossings apart");
}

/// Vertex numbers by place.
class PlaceIndex {
 public:
  explicit PlaceIndex(const Tin& tin) : at_(tin.points), order_(tin.points.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) { return less(at_[a], at_[b]); });
  }
  std::uint32_t operator()(Vec2 p) const {
    return *std::lower_bound(order_.begin(), order_.end(), p, [&](std::uint32_t a, Vec2 q) { return less(at_[a], q); });
  }

 private:
  static bool less(Vec2 a, Vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }
  const std::vector<Vec2>& at_;
  std::vector<std::uint32_t> order_;
};

/// Triangles in canonical order (scattered.h) and the fixed edges' numbers.
ConstrainedTin in_order(Tin tin, const ConstraintMesh& mesh) {
  struct Row {
    std::array<std::uint32_t, 3> v;
    std::array<bool, 3> fixed;
  };
  std::vector<Row> rows;
  rows.reserve(mesh.triangles().size());
  for (const auto& t : mesh.triangles()) {
    const auto first = static_cast<std::size_t>(std::min_element(t.v.begin(), t.v.end()) - t.v.begin());
    Row row{};
    for (std::size_t k = 0; k < 3; ++k) {
      row.v[k] = t.v[(first + k) % 3];
      row.fixed[k] = t.fixed[(first + k) % 3];
    }
    rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.v < b.v; });
  for (std::size_t t = 0; t < rows.size(); ++t) tin.triangles[t] = rows[t].v;
  build_neighbors(tin);
  ConstrainedTin result;
  const EdgeTable edges = build_edges(tin);
  for (std::size_t t = 0; t < rows.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (rows[t].fixed[k] && edges.triangles[edges.of_triangle[t][k]][0] == t)
        result.edges.push_back(edges.of_triangle[t][k]);
  std::sort(result.edges.begin(), result.edges.end());
  result.tin = std::move(tin);
  return result;
}

}  // namespace

double mean_spacing(std::span<const Vec3> points) {
  if (points.empty()) return 0;
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), 0};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), 0};
  }
  return std::sqrt((high.x - low.x) * (high.y - low.y) / static_cast<double>(points.size()));
}

std::vector<Vec3> with_steps(std::span<const Vec3> line, double longest) {
  std::vector<Vec3> dense;
  for (std::size_t k = 0; k < line.size(); ++k) {
    dense.push_back(line[k]);
    if (k + 1 == line.size()) break;
    // Two houses share a wall: places that differ by rounding would become vertices with needles between them.
    const bool forward = from_lesser_end(plan(line[k]), plan(line[k + 1]));
    const Vec3 &from = forward ? line[k] : line[k + 1], &to = forward ? line[k + 1] : line[k];
    const Vec3 along = to - from;
    const double pieces = std::min(1e6, std::ceil(norm(Vec2{along.x, along.y}) / longest));
    for (double i = 1; i < pieces; ++i) dense.push_back(from + ((forward ? i : pieces - i) / pieces) * along);
  }
  return dense;
}

ConstrainedTin triangulate_points(std::span<const Vec3> points, std::span<const std::vector<Vec3>> breaklines,
                                  ScatteredNotes* notes, BreaklineNotes* breakline_notes, const Context& context) {
  BreaklineNotes counted;
  std::vector<Line> lines = tidy(breaklines);
  drape(lines, points, counted, context);
  split_crossings(lines, counted, context);
  std::vector<Vec3> all(points.begin(), points.end());
  for (const Line& line : lines) {
    all.insert(all.end(), line.begin(), line.end());
    counted.lines += line.size() > 1 ? 1 : 0;
  }
  Tin tin = triangulate_points(all, notes, context);
  const PlaceIndex index(tin);
  ConstraintMesh mesh(tin);
  for (const Line& line : lines)
    for (std::size_t k = 0; k + 1 < line.size(); ++k) mesh.insert(index(plan(line[k])), index(plan(line[k + 1])));
  context.check();
  if (breakline_notes) *breakline_notes = counted;
  return in_order(std::move(tin), mesh);
}

}  // namespace retalho
