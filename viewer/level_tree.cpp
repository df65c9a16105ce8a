#include "level_tree.h"

#include <algorithm>
#include <queue>
#include <unordered_map>

namespace retalho::viewer {

LevelTree::LevelTree(int columns, int rows)
    : columns_(static_cast<std::uint32_t>(columns)),
      rows_(static_cast<std::uint32_t>(rows)),
      leaves_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

bool LevelTree::inside(int level, std::int64_t i, std::int64_t j) const {
  return i >= 0 && j >= 0 && i < (std::int64_t{columns_} << level) && j < (std::int64_t{rows_} << level);
}

/// Gives the new squares to `take`.
template <class Take>
void LevelTree::halve(const LevelSquare& s, const Take& take) {
  if (halved(s)) return;
  // A neighbour across a side must be there as a square of this level, halved or not.
  if (s.level > 0)
    for (const auto& [di, dj] : {std::array{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const std::int64_t i = std::int64_t{s.i} + di, j = std::int64_t{s.j} + dj;
      if (inside(s.level, i, j))
        halve({s.level - 1, static_cast<std::uint32_t>(i / 2), static_cast<std::uint32_t>(j / 2)}, take);
    }
  halved_.insert(key(s));
  leaves_ += 3;
  deepest_ = std::max(deepest_, s.level + 1);
  for (const std::uint32_t b : {0U, 1U})
    for (const std::uint32_t a : {0U, 1U}) take(LevelSquare{s.level + 1, 2 * s.i + a, 2 * s.j + b});
}

void LevelTree::refine(const std::function<double(const LevelSquare&)>& want, double enough, int deepest,
                       std::size_t most) {
  struct Waiting {
    double want;
    LevelSquare square;
    bool operator<(const Waiting& other) const {
      return want != other.want ? want < other.want : key(square) > key(other.square);
    }
  };
  std::priority_queue<Waiting> queue;
  const auto push = [&](const LevelSquare& s) {
    if (s.level < std::min(deepest, kDeepest)) queue.push({want(s), s});
  };
  for (std::uint32_t j = 0; j < rows_; ++j)
    for (std::uint32_t i = 0; i < columns_; ++i) push({0, i, j});
  while (!queue.empty() && leaves_ < most && queue.top().want > enough) {
    const LevelSquare s = queue.top().square;
    queue.pop();
    halve(s, push);
  }
}

template <class Take>
void LevelTree::each_leaf(const LevelSquare& s, const Take& take) const {
  if (!halved(s)) return take(s);
  for (const std::uint32_t b : {0U, 1U})
    for (const std::uint32_t a : {0U, 1U}) each_leaf({s.level + 1, 2 * s.i + a, 2 * s.j + b}, take);
}

LevelTree::Fans LevelTree::fans() const {
  Fans fans;
  fans.halves = 2 << deepest_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  const auto number = [&](std::uint32_t x, std::uint32_t y) {
    const auto [found, made] =
        numbers.emplace((static_cast<std::uint64_t>(x) << 32) | y, static_cast<std::uint32_t>(fans.places.size()));
    if (made) fans.places.push_back({x, y});
    return found->second;
  };
  std::vector<std::uint32_t> ring;
  const auto take = [&](const LevelSquare& s) {
    const std::uint32_t half = 1U << (deepest_ - s.level), west = 2 * half * s.i, north = 2 * half * s.j;
    const auto finer = [&](int di, int dj) {
      const std::int64_t i = std::int64_t{s.i} + di, j = std::int64_t{s.j} + dj;
      return inside(s.level, i, j) && halved({s.level, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
    };
    ring.clear();
    ring.push_back(number(west, north));
    if (finer(-1, 0)) ring.push_back(number(west, north + half));
    ring.push_back(number(west, north + 2 * half));
    if (finer(0, 1)) ring.push_back(number(west + half, north + 2 * half));
    ring.push_back(number(west + 2 * half, north + 2 * half));
    if (finer(1, 0)) ring.push_back(number(west + 2 * half, north + half));
    ring.push_back(number(west + 2 * half, north));
    if (finer(0, -1)) ring.push_back(number(west + half, north));
    const std::uint32_t middle = number(west + half, north + half);
    for (std::size_t k = 0; k < ring.size(); ++k)
      fans.triangles.push_back({middle, ring[k], ring[(k + 1) % ring.size()]});
  };
  for (std::uint32_t j = 0; j < rows_; ++j)
    for (std::uint32_t i = 0; i < columns_; ++i) each_leaf({0, i, j}, take);
  return fans;
}

}  // namespace retalho::viewer
