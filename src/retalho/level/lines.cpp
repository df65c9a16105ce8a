#include "retalho/level/lines.h"

#include <algorithm>

namespace retalho {

TracedLines find_lines(const Trace& trace) {
  const std::size_t n = trace.points.size();
  enum : std::uint8_t { none = 0, has_predecessor = 1, done = 2 };
  std::vector<std::uint8_t> state(n, none);
  for (const std::uint32_t p : trace.next)
    if (p != kNoPoint) state[p] = has_predecessor;
  TracedLines found;
  found.order.reserve(n);
  const auto walk = [&](std::uint32_t start, bool closed) {
    const std::size_t first = found.order.size();
    std::uint32_t p = start;
    do {
      state[p] = done;
      found.order.push_back(p);
      p = trace.next[p];
    } while (p != kNoPoint && p != start);
    found.lines.push_back({trace.level[start], closed, start, found.order.back(),
                           static_cast<std::uint32_t>(found.order.size() - first), first});
  };
  for (std::uint32_t p = 0; p < n; ++p)
    if (state[p] == none && trace.next[p] != kNoPoint) walk(p, false);
  for (std::uint32_t p = 0; p < n; ++p)
    if (state[p] == has_predecessor && trace.next[p] != kNoPoint) walk(p, true);
  std::sort(found.lines.begin(), found.lines.end(), [](const TracedLine& a, const TracedLine& b) {
    return a.level != b.level ? a.level < b.level : a.start < b.start;
  });
  return found;
}

}  // namespace retalho
