#include "retalho/level/clip.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace retalho {
namespace {

/// Parameters in (0, 1) where a segment passes from one cell to another, ascending, with both ends.
void cell_crossings(Vec2 a, Vec2 b, const GridDomain& grid, std::vector<double>& cuts) {
  cuts.assign(1, 0);
  const auto along = [&](double from, double to) {
    const double low = std::min(from, to), high = std::max(from, to);
    for (double line = std::ceil(low - 0.5) + 0.5; line < high; ++line) {
      const double t = (line - from) / (to - from);
      if (t > 0 && t < 1) cuts.push_back(t);
    }
  };
  along(a.x / grid.cell_width, b.x / grid.cell_width);
  along(-a.y / grid.cell_height, -b.y / grid.cell_height);
  cuts.push_back(1);
  std::sort(cuts.begin(), cuts.end());
}

}  // namespace

bool has_voids(const GridDomain& grid) {
  return grid.columns > 0 && !grid.valid.empty() &&
         grid.valid.count() != static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
}

void clip_to_cells(ContourSet& set, const GridDomain& grid) {
  std::vector<Vec2> points;
  std::vector<ContourLine> lines;
  std::vector<double> cuts;
  std::vector<std::vector<Vec2>> parts;
  for (const ContourLine& line : set.lines) {
    parts.clear();
    bool inside = false, whole = true;
    const std::size_t n = line.end - line.begin, segments = line.closed ? n : n - 1;
    for (std::size_t i = 0; i < segments; ++i) {
      const Vec2 a = set.points[line.begin + i], b = set.points[line.begin + (i + 1) % n];
      cell_crossings(a, b, grid, cuts);
      for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        if (cuts[k] == cuts[k + 1]) continue;
        const auto place = [&](double t) { return t == 0 ? a : t == 1 ? b : a + t * (b - a); };
        if (!grid.has_data(place(0.5 * (cuts[k] + cuts[k + 1])))) {
          inside = whole = false;
          continue;
        }
        if (!inside) parts.push_back({place(cuts[k])});
        inside = true;
        // Only corners of the line and ends are kept: passing between cells with data leaves no trace.
        if (k > 0 && parts.back().size() > 1 && cuts[k] != 0) parts.back().pop_back();
        parts.back().push_back(place(cuts[k + 1]));
      }
    }
    // A closed line that was cut goes on over its own start.
    if (line.closed && !whole && parts.size() > 1 && parts.front().front() == parts.back().back()) {
      parts.back().insert(parts.back().end(), parts.front().begin() + 1, parts.front().end());
      parts.front() = std::move(parts.back());
      parts.pop_back();
    }
    for (const std::vector<Vec2>& part : parts) {
      ContourLine out{line.level, line.closed && whole, points.size(), 0};
      points.insert(points.end(), part.begin(), part.end());
      if (out.closed) points.pop_back();
      out.end = points.size();
      if (out.end - out.begin >= 2) lines.push_back(out);
    }
  }
  set.points = std::move(points);
  set.lines = std::move(lines);
}

}  // namespace retalho
