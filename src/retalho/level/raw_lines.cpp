#include "retalho/level/raw_lines.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "retalho/core/parallel.h"
#include "retalho/level/lines.h"

namespace retalho {

void gather_lines(const Trace& trace, RawLines& raw, const Context& context) {
  const TracedLines traced = find_lines(trace);
  ContourSet& set = raw.set;
  const bool cells = !trace.cell.empty();
  set.points.resize(traced.order.size());
  if (cells) raw.cell.resize(traced.order.size());
  set.lines.resize(traced.lines.size());
  raw.ends.resize(traced.lines.size());
  // Every line has its place from the start; lines that turn out shorter leave gaps, closed below.
  std::vector<std::size_t> place(traced.lines.size());
  std::size_t total = 0;
  for (std::size_t l = 0; l < traced.lines.size(); ++l) {
    place[l] = total;
    total += traced.lines[l].count;
  }
  parallel_chunks(traced.lines.size(), 256, context, [&](std::size_t from, std::size_t to) {
    for (std::size_t l = from; l < to; ++l) {
      const TracedLine& line = traced.lines[l];
      const std::size_t begin = place[l];
      std::size_t end = begin;
      for (const std::uint32_t p : std::span(traced.order).subspan(line.first, line.count)) {
        if (end > begin && set.points[end - 1] == trace.points[p]) continue;
        if (cells) raw.cell[end] = trace.cell[p];
        set.points[end++] = trace.points[p];
      }
      if (line.closed && end > begin + 1 && set.points[end - 1] == set.points[begin]) --end;
      set.lines[l] = {line.level, line.closed, begin, end};
      raw.ends[l] = {line.start, line.stop};
    }
  });
  std::size_t write = 0;
  for (ContourLine& line : set.lines) {
    const std::size_t n = line.end - line.begin;
    if (write != line.begin) {
      std::copy_n(set.points.begin() + static_cast<std::ptrdiff_t>(line.begin), n,
                  set.points.begin() + static_cast<std::ptrdiff_t>(write));
      if (cells)
        std::copy_n(raw.cell.begin() + static_cast<std::ptrdiff_t>(line.begin), n,
                    raw.cell.begin() + static_cast<std::ptrdiff_t>(write));
    }
    line.begin = write;
    line.end = write += n;
  }
  set.points.resize(write);
  if (cells) raw.cell.resize(write);
}

void sort_lines(RawLines& lines) {
  ContourSet& set = lines.set;
  std::vector<std::size_t> order(set.lines.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return set.lines[a].level != set.lines[b].level ? set.lines[a].level < set.lines[b].level
                                                    : lines.ends[a][0] < lines.ends[b][0];
  });
  std::vector<ContourLine> sorted;
  std::vector<std::array<std::uint32_t, 2>> ends;
  std::vector<Vec2> points;
  sorted.reserve(order.size());
  ends.reserve(order.size());
  points.reserve(set.points.size());
  for (const std::size_t l : order) {
    const ContourLine& line = set.lines[l];
    sorted.push_back({line.level, line.closed, points.size(), points.size() + line.end - line.begin});
    ends.push_back(lines.ends[l]);
    points.insert(points.end(), set.points.begin() + static_cast<std::ptrdiff_t>(line.begin),
                  set.points.begin() + static_cast<std::ptrdiff_t>(line.end));
  }
  set.lines = std::move(sorted);
  set.points = std::move(points);
  lines.ends = std::move(ends);
}

}  // namespace retalho
