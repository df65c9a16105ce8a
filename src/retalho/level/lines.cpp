#include "retalho/level/lines.h"

#include <algorithm>

namespace retalho {

std::vector<TracedLine> find_lines(const Trace& trace) {
  const std::size_t n = trace.points.size();
  enum : std::uint8_t { none = 0, has_predecessor = 1, done = 2 };
  std::vector<std::uint8_t> state(n, none);
  for (const std::uint32_t p : trace.next)
    if (p != kNoPoint) state[p] = has_predecessor;
  std::vector<TracedLine> lines;
  const auto walk = [&](std::uint32_t start, bool closed) {
    std::uint32_t count = 0, p = start, stop = start;
    do {
      state[p] = done;
      ++count;
      stop = p;
      p = trace.next[p];
    } while (p != kNoPoint && p != start);
    lines.push_back({trace.level[start], closed, start, stop, count});
  };
  for (std::uint32_t p = 0; p < n; ++p)
    if (state[p] == none && trace.next[p] != kNoPoint) walk(p, false);
  for (std::uint32_t p = 0; p < n; ++p)
    if (state[p] == has_predecessor && trace.next[p] != kNoPoint) walk(p, true);
  std::sort(lines.begin(), lines.end(), [](const TracedLine& a, const TracedLine& b) {
    return a.level != b.level ? a.level < b.level : a.start < b.start;
  });
  return lines;
}

}  // namespace retalho
