#include "retalho/level/line_joiner.h"

#include <algorithm>
#include <utility>

#include "retalho/core/error.h"

namespace retalho {

std::int64_t LineJoiner::place_of(std::uint32_t point, const GridStrip& strip, bool last) const {
  if (point < strip.top) return point;
  const std::uint32_t below = point - strip.bottom;  // wraps round where the point comes before
  return !last && below < strip.bottom_count ? std::int64_t{strip.top} + below : kEnd;
}

std::uint32_t LineJoiner::new_chain(int level) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(chains_.size()));
    chains_.emplace_back();
  }
  const std::uint32_t c = free_.back();
  free_.pop_back();
  chains_[c] = {level, {}, kNoPoint, kEnd, kEnd};
  return c;
}

void LineJoiner::add_piece(const RawLines& lines, std::size_t line, const GridStrip& strip, bool last) {
  const ContourLine& piece = lines.set.lines[line];
  const std::int64_t head = place_of(lines.ends[line][0], strip, last),
                     tail = place_of(lines.ends[line][1], strip, last);
  const auto take_waiting = [&](std::int64_t place) {
    if (place == kEnd || place >= strip.top) return kNoPoint;
    return std::exchange(waiting_[static_cast<std::size_t>(place)], {}).chain;
  };
  const std::uint32_t before = take_waiting(head), after = take_waiting(tail);
  const auto begin = lines.set.points.begin();
  Part part{joined(lines.ends[line][0]),
            {begin + static_cast<std::ptrdiff_t>(piece.begin), begin + static_cast<std::ptrdiff_t>(piece.end)}};
  const std::uint32_t stop = joined(lines.ends[line][1]);
  const std::int64_t below_head = head >= strip.top ? head : kEnd, below_tail = tail >= strip.top ? tail : kEnd;

  std::uint32_t c = before;
  if (before == kNoPoint && after != kNoPoint) {
    c = after;
    chains_[c].parts.push_front(std::move(part));
    chains_[c].head = below_head;
  } else {
    if (c == kNoPoint) {
      c = new_chain(piece.level);
      chains_[c].head = below_head;
    }
    Chain& chain = chains_[c];
    chain.parts.push_back(std::move(part));
    chain.stop = stop;
    chain.tail = below_tail;
    if (after == c) return finish(c, true);
    if (after != kNoPoint) {
      Chain& rest = chains_[after];
      chain.parts.splice(chain.parts.end(), rest.parts);
      chain.stop = rest.stop;
      chain.tail = rest.tail;
      if (rest.tail != kEnd) waiting_[static_cast<std::size_t>(rest.tail)].chain = c;
      free_.push_back(after);
    }
  }
  if (below_head != kEnd) waiting_[static_cast<std::size_t>(below_head)] = {c, true};
  if (below_tail != kEnd) waiting_[static_cast<std::size_t>(below_tail)] = {c, false};
  finish_if_whole(c);
}

void LineJoiner::finish_if_whole(std::uint32_t c) {
  if (chains_[c].head == kEnd && chains_[c].tail == kEnd) finish(c, false);
}

void LineJoiner::finish(std::uint32_t c, bool closed) {
  Chain& chain = chains_[c];
  if (closed) {
    const auto first = std::min_element(chain.parts.begin(), chain.parts.end(),
                                        [](const Part& a, const Part& b) { return a.start < b.start; });
    chain.parts.splice(chain.parts.end(), chain.parts, chain.parts.begin(), first);
  }
  ContourSet& set = done_.set;
  const std::size_t begin = set.points.size();
  for (const Part& part : chain.parts) {
    if (set.points.size() > begin) set.points.pop_back();  // it is this part's first
    set.points.insert(set.points.end(), part.points.begin(), part.points.end());
  }
  if (closed && set.points.size() > begin + 1) set.points.pop_back();
  set.lines.push_back({chain.level, closed, begin, set.points.size()});
  done_.ends.push_back({chain.parts.front().start, chain.stop});
  chain.parts.clear();
  free_.push_back(c);
}

void LineJoiner::leave(const GridStrip& strip, bool last) {
  for (std::size_t place = 0; place < strip.top; ++place) {
    const Waiting& w = waiting_[place];
    if (w.chain == kNoPoint) continue;
    (w.head ? chains_[w.chain].head : chains_[w.chain].tail) = kEnd;
    finish_if_whole(w.chain);
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + strip.top);
  for (std::size_t place = 0; place < waiting_.size(); ++place) {
    const Waiting& w = waiting_[place];
    if (w.chain != kNoPoint)
      (w.head ? chains_[w.chain].head : chains_[w.chain].tail) = static_cast<std::int64_t>(place);
  }
  if (last) return;
  std::vector<std::uint32_t> seam(strip.bottom_count);
  for (std::uint32_t i = 0; i < strip.bottom_count; ++i) seam[i] = joined(strip.bottom + i);
  next_seam_ = std::move(seam);
}

void LineJoiner::add(RawLines& lines, const GridStrip& strip, bool last) {
  seam_ = std::move(next_seam_);
  seam_.resize(strip.top);  // of the first strip: numbered below
  waiting_.resize(strip.top);
  if (total_ == 0)
    for (std::uint32_t i = 0; i < strip.top; ++i) seam_[i] = i;
  // Points of the first row have their numbers from the strip above, the others follow its last one.
  const std::size_t known = total_ == 0 ? 0 : strip.top;
  offset_ = total_ - known;
  total_ += strip.trace.points.size() - known;
  if (total_ >= kNoPoint)
    throw BadInput(
        "the level lines have more than four billion traced vertices: ask for fewer levels or a larger tolerance");
  waiting_.resize(strip.top + (last ? 0 : strip.bottom_count));

  done_.set.points.clear();
  done_.set.lines.clear();
  done_.ends.clear();
  std::size_t kept = 0;
  for (std::size_t l = 0; l < lines.set.lines.size(); ++l) {
    const auto [start, stop] = lines.ends[l];
    const bool whole =
        lines.set.lines[l].closed || (place_of(start, strip, last) == kEnd && place_of(stop, strip, last) == kEnd);
    if (!whole) {
      add_piece(lines, l, strip, last);
      continue;
    }
    lines.set.lines[kept] = lines.set.lines[l];
    lines.ends[kept++] = {joined(start), joined(stop)};
  }
  leave(strip, last);
  lines.set.lines.resize(kept);
  lines.ends.resize(kept);
  if (done_.set.lines.empty()) return;
  const std::size_t moved = lines.set.points.size();
  lines.set.points.insert(lines.set.points.end(), done_.set.points.begin(), done_.set.points.end());
  for (std::size_t l = 0; l < done_.set.lines.size(); ++l) {
    ContourLine line = done_.set.lines[l];
    line.begin += moved;
    line.end += moved;
    lines.set.lines.push_back(line);
    lines.ends.push_back(done_.ends[l]);
  }
  sort_lines(lines);
}

}  // namespace retalho
