#include "retalho/level/piece_pairs.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "retalho/core/parallel.h"

namespace retalho {
namespace {

struct Box {
  Vec2 low, high;
};

Box box_of(const Cubic& c) {
  Box b{c[0], c[0]};
  for (const Vec2 p : c) {
    b.low = {std::min(b.low.x, p.x), std::min(b.low.y, p.y)};
    b.high = {std::max(b.high.x, p.x), std::max(b.high.y, p.y)};
  }
  return b;
}

struct Cells {
  Vec2 origin;
  double size = 1;
  std::int64_t columns = 1;
  std::int64_t column(double x) const { return static_cast<std::int64_t>(std::floor((x - origin.x) / size)); }
  std::int64_t row(double y) const { return static_cast<std::int64_t>(std::floor((y - origin.y) / size)); }
};

struct Entry {
  std::int64_t cell;
  std::size_t item;
};

/// Cells about as large as the pieces.
Cells choose_cells(const std::vector<Box>& boxes) {
  Box all = boxes.front();
  double sum = 0;
  for (const Box& b : boxes) {
    all.low = {std::min(all.low.x, b.low.x), std::min(all.low.y, b.low.y)};
    all.high = {std::max(all.high.x, b.high.x), std::max(all.high.y, b.high.y)};
    sum += std::max(b.high.x - b.low.x, b.high.y - b.low.y);
  }
  Cells cells;
  cells.origin = all.low;
  const double extent = std::max(all.high.x - all.low.x, all.high.y - all.low.y);
  cells.size = std::max({1.5 * sum / static_cast<double>(boxes.size()), extent * 1e-6, 1e-300});
  cells.columns = cells.column(all.high.x) + 1;
  return cells;
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> touching_pairs(const std::vector<PairItem>& items,
                                                                const Context& context) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  if (items.empty()) return found;
  std::vector<Box> boxes;
  boxes.reserve(items.size());
  for (const PairItem& item : items) boxes.push_back(box_of(*item.cubic));
  const Cells cells = choose_cells(boxes);
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < items.size(); ++i)
    for (std::int64_t r = cells.row(boxes[i].low.y); r <= cells.row(boxes[i].high.y); ++r)
      for (std::int64_t c = cells.column(boxes[i].low.x); c <= cells.column(boxes[i].high.x); ++c)
        entries.push_back({r * cells.columns + c, i});
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.cell != b.cell ? a.cell < b.cell : a.item < b.item; });
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (i == 0 || entries[i].cell != entries[i - 1].cell) starts.push_back(i);
  starts.push_back(entries.size());

  constexpr std::size_t kGrain = 256;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> parts((starts.size() + kGrain - 1) / kGrain);
  parallel_chunks(starts.size() - 1, kGrain, context, [&](std::size_t begin, std::size_t end) {
    auto& part = parts[begin / kGrain];
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t x = starts[k]; x < starts[k + 1]; ++x)
        for (std::size_t y = x + 1; y < starts[k + 1]; ++y) {
          const std::size_t i = entries[x].item, j = entries[y].item;
          if (!items[i].fresh && !items[j].fresh) continue;
          const Vec2 low{std::max(boxes[i].low.x, boxes[j].low.x), std::max(boxes[i].low.y, boxes[j].low.y)};
          if (low.x > std::min(boxes[i].high.x, boxes[j].high.x) || low.y > std::min(boxes[i].high.y, boxes[j].high.y))
            continue;
          // A pair that shares several cells is looked at in the first of them.
          if (cells.row(low.y) * cells.columns + cells.column(low.x) != entries[x].cell) continue;
          if (!apart(*items[i].cubic, *items[j].cubic, items[i].next == j, items[j].next == i)) part.push_back({i, j});
        }
  });
  for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace retalho
