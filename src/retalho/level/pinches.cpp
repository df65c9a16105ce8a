#include "retalho/level/pinches.h"

#include <algorithm>
#include <cstddef>
#include <map>

namespace retalho {

Pinches::Pinches(const std::vector<DirectedBorder>& border, const ContourSet& set) {
  std::vector<std::pair<double, double>> starts;
  starts.reserve(border.size() + 2 * set.lines.size());
  for (const DirectedBorder& piece : border) starts.emplace_back(piece.place.x, piece.place.y);
  for (const ContourLine& line : set.lines)
    if (!line.closed)
      for (const std::size_t end : {line.begin, line.end - 1})
        starts.emplace_back(set.points[end].x, set.points[end].y);
  std::sort(starts.begin(), starts.end());
  for (std::size_t i = 1; i < starts.size(); ++i)
    if (starts[i] == starts[i - 1]) places_.insert(starts[i]);
}

void Pinches::part(std::vector<std::vector<Vec2>>& rings) const {
  if (places_.empty()) return;
  const std::size_t given = rings.size();
  for (std::size_t r = 0; r < given; ++r) {
    std::vector<Vec2> open;
    std::map<std::pair<double, double>, std::size_t> seen;  // where `open` passes a place
    for (const Vec2 p : std::vector<Vec2>(std::move(rings[r]))) {
      if (holds(p)) {
        const auto [at, first] = seen.emplace(std::pair{p.x, p.y}, open.size());
        if (!first) {
          // Back at the place: what was walked since is a loop of its own.
          const auto begin = open.begin() + static_cast<std::ptrdiff_t>(at->second);
          std::vector<Vec2> loop(begin, open.end());
          for (std::size_t i = 1; i < loop.size(); ++i) seen.erase({loop[i].x, loop[i].y});
          open.erase(begin + 1, open.end());
          if (loop.size() > 2) rings.push_back(std::move(loop));
          continue;
        }
      }
      open.push_back(p);
    }
    rings[r] = std::move(open);
  }
}

}  // namespace retalho
