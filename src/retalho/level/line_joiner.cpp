#include "retalho/level/line_joiner.h"

#include <span>
#include <utility>

#include "retalho/core/error.h"

namespace retalho {

LineChains::Place LineJoiner::place_of(std::uint32_t point, const GridStrip& strip, bool last) const {
  const std::uint32_t below = point - strip.bottom;  // wraps round where the point comes before
  const bool meets = point < strip.top || (!last && below < strip.bottom_count);
  return meets ? joined(point) : LineChains::kEnd;
}

void LineJoiner::add(RawLines& lines, const GridStrip& strip, bool last) {
  seam_ = std::move(next_seam_);
  seam_.resize(strip.top);  // of the first strip: numbered below
  if (total_ == 0)
    for (std::uint32_t i = 0; i < strip.top; ++i) seam_[i] = i;
  // Points of the first row have their numbers from the strip above, the others follow its last one.
  const std::size_t known = total_ == 0 ? 0 : strip.top;
  offset_ = total_ - known;
  total_ += strip.trace.points.size() - known;
  if (total_ >= kNoPoint)
    throw BadInput(
        "the level lines have more than four billion traced vertices: ask for fewer levels or a larger tolerance");

  std::size_t kept = 0;
  for (std::size_t l = 0; l < lines.set.lines.size(); ++l) {
    const ContourLine line = lines.set.lines[l];
    const auto [start, stop] = lines.ends[l];
    const LineChains::Place head = place_of(start, strip, last), tail = place_of(stop, strip, last);
    if (line.closed || (head == LineChains::kEnd && tail == LineChains::kEnd)) {
      lines.set.lines[kept] = line;
      lines.ends[kept++] = {joined(start), joined(stop)};
      continue;
    }
    chains_.add({line.level, head, tail, joined(start), joined(stop),
                 std::span(lines.set.points).subspan(line.begin, line.end - line.begin)});
  }
  lines.set.lines.resize(kept);
  lines.ends.resize(kept);
  // What still waits on the first row waits for nothing; the last row becomes the next strip's first.
  for (const std::uint32_t root : seam_) chains_.close(root);
  chains_.move_done(lines);
  if (lines.set.lines.size() > kept) sort_lines(lines);
  if (last) return;
  std::vector<std::uint32_t> seam(strip.bottom_count);
  for (std::uint32_t i = 0; i < strip.bottom_count; ++i) seam[i] = joined(strip.bottom + i);
  next_seam_ = std::move(seam);
}

}  // namespace retalho
