#include "retalho/level/bands.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "retalho/core/error.h"
#include "retalho/level/pinches.h"

namespace retalho {
namespace {

/// What follows a root on the border: the nodes on the way, and the next root.
struct BorderStep {
  std::uint32_t next = kNoPoint;
  std::vector<Vec2> nodes;
};

/// For each border edge the one that follows; where several do, the leftmost: a pinched place stays a touching point.
std::vector<std::size_t> successors(const std::vector<DirectedBorder>& border) {
  std::unordered_multimap<std::uint64_t, std::size_t> from;
  from.reserve(border.size());
  for (std::size_t e = 0; e < border.size(); ++e) from.emplace(border[e].from, e);
  std::vector<std::size_t> next(border.size());
  for (std::size_t e = 0; e < border.size(); ++e) {
    const Vec2 in = border[e].along;
    double best = -10;
    const auto [first, last] = from.equal_range(border[e].to);
    if (first == last) throw Error(Error::Kind::internal, "bands: the border of the valid area has a gap");
    for (auto it = first; it != last; ++it) {
      const Vec2 out = border[it->second].along;
      const double turn = std::atan2(cross(in, out), dot(in, out));
      // Straight back is the sharpest turn to the right.
      const double angle = turn > 3.14159 ? -turn : turn;
      if (angle > best) {
        best = angle;
        next[e] = it->second;
      }
    }
  }
  return next;
}

class BandBuilder {
 public:
  BandBuilder(const ContourSet& set, const std::vector<std::array<std::uint32_t, 2>>& ends) : set_(set), ends_(ends) {
    rings_.resize(set.levels.size() + 1);
  }

  void walk_border(const std::vector<DirectedBorder>& border, const BandLocator* around) {
    const std::vector<std::size_t> next = successors(border);
    pinches_ = Pinches(border, set_);
    std::vector<std::uint8_t> done(border.size(), 0);
    for (std::size_t start = 0; start < border.size(); ++start) {
      if (done[start] != 0) continue;
      // One closed chain: nodes and roots in order.
      std::vector<std::pair<std::uint32_t, Vec2>> items;
      std::size_t first_root = 0;
      bool has_root = false;
      int band = DirectedBorder::kUnknownBand;
      std::size_t middle = start;
      for (std::size_t e = start; done[e] == 0; e = next[e]) {
        done[e] = 1;
        if (border[e].band >= 0) band = border[e].band;
        if (border[e].band == DirectedBorder::kAskMiddle) middle = e;
        items.emplace_back(kNoPoint, border[e].place);
        for (const std::uint32_t root : border[e].roots) {
          if (!has_root) first_root = items.size();
          has_root = true;
          items.emplace_back(root, Vec2{});
        }
      }
      if (!has_root) {
        std::vector<Vec2> ring;
        ring.reserve(items.size());
        for (const auto& item : items) ring.push_back(item.second);
        if (band < 0 && around != nullptr)
          band = around->band_at(0.5 * (border[middle].place + border[next[middle]].place));
        if (band < 0) throw Error(Error::Kind::internal, "bands: a border without lines lies outside of the area");
        rings_[static_cast<std::size_t>(band)].push_back(std::move(ring));
        continue;
      }
      std::uint32_t current = items[first_root].first;
      std::vector<Vec2> nodes;
      for (std::size_t i = 1; i <= items.size(); ++i) {
        const auto& [root, place] = items[(first_root + i) % items.size()];
        if (root == kNoPoint) {
          nodes.push_back(place);
        } else {
          after_[current] = {root, std::move(nodes)};
          nodes.clear();
          current = root;
        }
      }
    }
  }

  void walk_lines() {
    for (std::size_t l = 0; l < set_.lines.size(); ++l) {
      if (set_.lines[l].closed) continue;
      starts_[ends_[l][0]] = l;
      stops_[ends_[l][1]] = l;
    }
    std::array<std::vector<std::uint8_t>, 2> used;
    for (auto& u : used) u.assign(set_.lines.size(), 0);
    for (std::size_t first = 0; first < set_.lines.size(); ++first)
      for (const bool backward : {false, true}) {
        std::vector<Vec2> ring;
        const int band = set_.lines[first].level + (backward ? 0 : 1);
        if (set_.lines[first].closed) {
          append(first, backward, ring);
        } else {
          std::size_t line = first;
          bool reversed = backward;
          if (used[reversed ? 1 : 0][line] != 0) continue;
          while (used[reversed ? 1 : 0][line] == 0) {
            used[reversed ? 1 : 0][line] = 1;
            if (set_.lines[line].level + (reversed ? 0 : 1) != band)
              throw Error(Error::Kind::internal, "bands: a region changes its level");
            append(line, reversed, ring);
            const auto step = after_.find(ends_[line][reversed ? 0 : 1]);
            if (step == after_.end()) throw Error(Error::Kind::internal, "bands: a line ends inside the area");
            ring.insert(ring.end(), step->second.nodes.begin(), step->second.nodes.end());
            if (const auto start = starts_.find(step->second.next); start != starts_.end()) {
              line = start->second;
              reversed = false;
            } else if (const auto stop = stops_.find(step->second.next); stop != stops_.end()) {
              line = stop->second;
              reversed = true;
            } else {
              throw Error(Error::Kind::internal, "bands: a border root without a line");
            }
          }
        }
        rings_[static_cast<std::size_t>(band)].push_back(std::move(ring));
      }
  }

  BandSet finish() {
    BandSet bands;
    bands.levels = set_.levels;
    for (std::size_t b = 0; b < rings_.size(); ++b) {
      pinches_.part(rings_[b]);
      nest_rings(static_cast<int>(b), std::move(rings_[b]), bands.polygons);
    }
    return bands;
  }

 private:
  void append(std::size_t line, bool reversed, std::vector<Vec2>& ring) const {
    const auto begin = set_.points.begin() + static_cast<std::ptrdiff_t>(set_.lines[line].begin);
    const auto end = set_.points.begin() + static_cast<std::ptrdiff_t>(set_.lines[line].end);
    if (reversed)
      ring.insert(ring.end(), std::make_reverse_iterator(end), std::make_reverse_iterator(begin));
    else
      ring.insert(ring.end(), begin, end);
  }

  const ContourSet& set_;
  const std::vector<std::array<std::uint32_t, 2>>& ends_;
  std::vector<std::vector<std::vector<Vec2>>> rings_;
  Pinches pinches_;
  std::unordered_map<std::uint32_t, BorderStep> after_;
  std::unordered_map<std::uint32_t, std::size_t> starts_, stops_;
};

/// Adds the roots of all levels in the order of the walk.
void add_roots(DirectedBorder& piece, std::vector<BorderRoot>& roots) {
  std::stable_sort(roots.begin(), roots.end(), [&](const BorderRoot& a, const BorderRoot& b) {
    return dot(a.place - piece.place, piece.along) < dot(b.place - piece.place, piece.along);
  });
  for (const BorderRoot& root : roots) piece.roots.push_back(root.point);
}

}  // namespace

std::vector<DirectedBorder> grid_border(const FixedGrid& grid, const FixedLevels& levels,
                                        std::vector<BorderEdge> edges) {
  std::unordered_map<std::uint64_t, std::vector<BorderRoot>> roots;
  const auto key = [&](int column, int row, bool horizontal) {
    return 2 * static_cast<std::uint64_t>(grid.node(column, row)) + (horizontal ? 1 : 0);
  };
  for (BorderEdge& e : edges) roots.emplace(key(e.column, e.row, e.horizontal), std::move(e.roots));
  std::vector<DirectedBorder> border;
  const auto add = [&](int column, int row, bool horizontal, bool forward) {
    const int c1 = column + (horizontal ? 1 : 0), r1 = row + (horizontal ? 0 : 1);
    const int c = forward ? column : c1, r = forward ? row : r1;
    DirectedBorder piece{
        grid.node(c, r),
        grid.node(forward ? c1 : column, forward ? r1 : row),
        {c * grid.cell_width, -r * grid.cell_height},
        {(forward ? c1 - c : column - c) * grid.cell_width, (forward ? r - r1 : r - row) * grid.cell_height},
        levels.at_most(2.0 * grid.z[grid.node(c, r)]),
        {}};
    if (const auto found = roots.find(key(column, row, horizontal)); found != roots.end())
      add_roots(piece, found->second);
    border.push_back(std::move(piece));
  };
  for (int r = 0; r < grid.rows; ++r)
    for (int c = 0; c < grid.columns; ++c) {
      if (c + 1 < grid.columns) {
        const bool above = grid.has_patch(c, r - 1), below = grid.has_patch(c, r);
        if (above != below) add(c, r, true, above);
      }
      if (r + 1 < grid.rows) {
        const bool left = grid.has_patch(c - 1, r), right = grid.has_patch(c, r);
        if (left != right) add(c, r, false, right);
      }
    }
  return border;
}

std::vector<DirectedBorder> terrain_border(const Terrain& terrain, const EdgeTable& edges, double per_unit,
                                           const FixedLevels& levels, const OuterRoots& outer, const Trace& trace) {
  std::vector<DirectedBorder> border;
  std::vector<BorderRoot> roots;
  const Tin& tin = terrain.tin;
  for (std::size_t t = 0; t < tin.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (tin.neighbors[t][k] != kNone) continue;
      const std::uint32_t a = tin.triangles[t][(k + 1) % 3], b = tin.triangles[t][(k + 2) % 3];
      DirectedBorder piece{a,
                           b,
                           tin.points[a],
                           tin.points[b] - tin.points[a],
                           levels.at_most(2 * std::nearbyint(tin.heights[a] * per_unit)),
                           {}};
      const std::size_t first = static_cast<std::size_t>(outer.halves) * edges.of_triangle[t][k];
      roots.clear();
      for (std::uint32_t i = outer.start[first]; i < outer.start[first + static_cast<std::size_t>(outer.halves)]; ++i)
        roots.push_back({outer.roots[i].point, trace.points[outer.roots[i].point]});
      add_roots(piece, roots);
      border.push_back(std::move(piece));
    }
  return border;
}

BandSet build_bands(const ContourSet& set, const std::vector<std::array<std::uint32_t, 2>>& ends,
                    const std::vector<DirectedBorder>& border, const BandLocator* around) {
  BandBuilder builder(set, ends);
  builder.walk_border(border, around);
  builder.walk_lines();
  return builder.finish();
}

}  // namespace retalho
