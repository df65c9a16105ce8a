#include "retalho/level/line_chains.h"

#include <algorithm>
#include <utility>

namespace retalho {

std::uint32_t LineChains::take_waiting(Place place) {
  if (place == kEnd) return kNone;
  const auto found = waiting_.find(place);
  if (found == waiting_.end()) return kNone;
  const std::uint32_t chain = found->second;
  waiting_.erase(found);
  return chain;
}

void LineChains::wait(Place place, std::uint32_t chain) {
  if (place != kEnd) waiting_.insert_or_assign(place, chain);
}

std::uint32_t LineChains::new_chain(int level) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(chains_.size()));
    chains_.emplace_back();
  }
  const std::uint32_t c = free_.back();
  free_.pop_back();
  chains_[c] = {level, {}, 0, kEnd, kEnd};
  return c;
}

void LineChains::add(const Piece& piece) {
  const std::uint32_t before = take_waiting(piece.head), after = take_waiting(piece.tail);
  Part part{piece.start, {piece.points.begin(), piece.points.end()}};
  std::uint32_t c = before;
  if (before == kNone && after != kNone) {
    c = after;
    chains_[c].parts.push_front(std::move(part));
    chains_[c].head = piece.head;
    wait(piece.head, c);
    return finish_if_whole(c);
  }
  if (c == kNone) {
    c = new_chain(piece.level);
    chains_[c].head = piece.head;
    wait(piece.head, c);
  }
  Chain& chain = chains_[c];
  chain.parts.push_back(std::move(part));
  chain.stop = piece.stop;
  chain.tail = piece.tail;
  if (after == c) return finish(c, true);
  if (after != kNone) {
    Chain& rest = chains_[after];
    chain.parts.splice(chain.parts.end(), rest.parts);
    chain.stop = rest.stop;
    chain.tail = rest.tail;
    free_.push_back(after);
  }
  wait(chain.tail, c);
  finish_if_whole(c);
}

void LineChains::close(Place place) {
  const std::uint32_t c = take_waiting(place);
  if (c == kNone) return;
  Chain& chain = chains_[c];
  (chain.head == place ? chain.head : chain.tail) = kEnd;
  finish_if_whole(c);
}

void LineChains::finish_if_whole(std::uint32_t c) {
  if (chains_[c].head == kEnd && chains_[c].tail == kEnd) finish(c, false);
}

void LineChains::finish(std::uint32_t c, bool closed) {
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

void LineChains::move_done(RawLines& lines) {
  ContourSet& set = done_.set;
  const std::size_t moved = lines.set.points.size();
  lines.set.points.insert(lines.set.points.end(), set.points.begin(), set.points.end());
  for (ContourLine line : set.lines) {
    line.begin += moved;
    line.end += moved;
    lines.set.lines.push_back(line);
  }
  lines.ends.insert(lines.ends.end(), done_.ends.begin(), done_.ends.end());
  set.points.clear();
  set.lines.clear();
  done_.ends.clear();
}

}  // namespace retalho
