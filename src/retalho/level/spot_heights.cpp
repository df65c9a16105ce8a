#include "retalho/level/spot_heights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <unordered_map>

#include "retalho/core/error.h"

namespace retalho {
namespace {

/// Samples and who touches whom; voids have no neighbours and are nobody's.
struct Samples {
  std::vector<double> heights;
  std::vector<std::uint8_t> usable, border;
  std::function<void(std::uint32_t, std::vector<std::uint32_t>&)> neighbours;  ///< usable ones, ascending
};

struct Extremum {
  std::uint32_t sample;
  double prominence;
};

/// Regions that grow downwards from their summits; when two meet, the lower summit's prominence is known.
class Flood {
 public:
  Flood(const Samples& samples, double sign) : s_(samples), sign_(sign) {}

  std::vector<Extremum> run(double least, const Context& context) {
    const auto n = static_cast<std::uint32_t>(s_.heights.size());
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < n; ++i)
      if (s_.usable[i] != 0) order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return level(a) != level(b) ? level(a) > level(b) : a < b; });
    parent_.assign(n, kNone);
    open_.assign(n, 0);
    std::vector<Extremum> found;
    std::vector<std::uint32_t> around;
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k % 65536 == 0) context.check();
      const std::uint32_t i = order[k];
      parent_[i] = i;  // the root of a region is its summit
      s_.neighbours(i, around);
      for (const std::uint32_t j : around) {
        if (parent_[j] == kNone) continue;
        std::uint32_t a = root(i), b = root(j);
        if (a == b) continue;
        if (level(b) > level(a) || (level(b) == level(a) && b < a)) std::swap(a, b);
        const double prominence = level(b) - level(i);
        if (prominence >= least && open_[b] == 0) found.push_back({b, prominence});
        if (level(a) == level(b)) open_[a] |= open_[b];
        parent_[b] = a;
      }
      const std::uint32_t top = root(i);
      if (s_.border[i] != 0 && level(i) == level(top)) open_[top] = 1;
    }
    // What no higher ground took over: the summit of each connected part, as prominent as the part is high.
    std::vector<double> lowest(n, 0);
    for (const std::uint32_t i : order) lowest[root(i)] = level(i);
    for (const std::uint32_t i : order)
      if (root(i) == i && open_[i] == 0 && level(i) - lowest[i] >= least) found.push_back({i, level(i) - lowest[i]});
    return found;
  }

 private:
  double level(std::uint32_t i) const { return sign_ * s_.heights[i]; }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  const Samples& s_;
  double sign_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> open_;
};

/// Of the samples of one height around `first`, the one that is deepest inside.
std::uint32_t middle_of_flat(const Samples& samples, std::uint32_t first) {
  enum : std::uint8_t { inside = 1, reached = 2 };
  std::vector<std::uint32_t> flat{first}, around, layer;
  std::unordered_map<std::uint32_t, std::uint8_t> state{{first, inside}};
  const double height = samples.heights[first];
  for (std::size_t k = 0; k < flat.size(); ++k) {
    samples.neighbours(flat[k], around);
    for (const std::uint32_t j : around)
      if (samples.heights[j] == height && state.emplace(j, inside).second) flat.push_back(j);
  }
  // Layers from the shore inwards; the last one reached is the middle.
  for (const std::uint32_t i : flat) {
    samples.neighbours(i, around);
    if (std::any_of(around.begin(), around.end(), [&](std::uint32_t j) { return !state.contains(j); }))
      layer.push_back(i);
  }
  for (const std::uint32_t i : layer) state[i] = reached;
  std::uint32_t last = first;
  for (std::size_t k = 0; k < layer.size(); ++k) {
    last = layer[k];
    samples.neighbours(last, around);
    for (const std::uint32_t j : around)
      if (const auto found = state.find(j); found != state.end() && found->second == inside) {
        found->second = reached;
        layer.push_back(j);
      }
  }
  return last;
}

using Place = std::function<SpotHeight(std::uint32_t)>;

std::vector<SpotHeight> find(const Samples& samples, double prominence, const Place& place, const Context& context) {
  std::vector<SpotHeight> spots;
  std::vector<std::uint32_t> around;
  for (const double sign : {1.0, -1.0})
    for (const Extremum& e : Flood(samples, sign).run(prominence, context)) {
      samples.neighbours(e.sample, around);
      const bool flat = std::any_of(around.begin(), around.end(),
                                    [&](std::uint32_t j) { return samples.heights[j] == samples.heights[e.sample]; });
      const std::uint32_t sample = flat ? middle_of_flat(samples, e.sample) : e.sample;
      SpotHeight spot = place(sample);
      spot.prominence = e.prominence;
      spot.summit = sign > 0;
      spots.push_back(spot);
    }
  std::stable_sort(spots.begin(), spots.end(),
                   [](const SpotHeight& a, const SpotHeight& b) { return a.prominence > b.prominence; });
  return spots;
}

/// Newton's way from a sample to where the gradient vanishes, inside of half a cell; the sample itself where that
/// fails.
SpotHeight refined(const BicubicGrid& grid, int column, int row) {
  const Vec2 start{column * grid.cell_width, -row * grid.cell_height};
  const double here =
      grid.z[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column)];
  Vec2 p = start;
  constexpr int kSteps = 12;
  for (int step = 0; step < kSteps; ++step) {
    const std::optional<Jet> jet = grid.at(p);
    if (!jet) return {start, here};
    const double det = jet->xx * jet->yy - jet->xy * jet->xy;
    if (!(det > 0)) return {start, here};  // no extremum's curvature
    const Vec2 move{(jet->yy * jet->gradient.x - jet->xy * jet->gradient.y) / det,
                    (jet->xx * jet->gradient.y - jet->xy * jet->gradient.x) / det};
    p = p - move;
    if (std::abs(p.x - start.x) > grid.cell_width || std::abs(p.y - start.y) > grid.cell_height) return {start, here};
    if (norm(move) < 1e-6 * grid.cell_width) break;
  }
  const std::optional<Jet> jet = grid.at(p);
  return jet ? SpotHeight{p, jet->value} : SpotHeight{start, here};
}

void check(double prominence) {
  if (!(prominence > 0) || !std::isfinite(prominence))
    throw BadInput(fmt::format("the prominence of spot heights must be a positive number, not {}", prominence));
}

}  // namespace

std::vector<SpotHeight> find_spot_heights(const BicubicGrid& grid, double prominence, const Context& context) {
  check(prominence);
  Samples samples;
  const std::size_t n = grid.z.size();
  samples.heights = grid.z;
  samples.usable.assign(n, 1);
  samples.border.assign(n, 0);
  const auto index = [&](int c, int r) {
    return static_cast<std::uint32_t>(static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.columns) +
                                      static_cast<std::size_t>(c));
  };
  for (int r = 0; r < grid.rows; ++r)
    for (int c = 0; c < grid.columns; ++c) samples.usable[index(c, r)] = grid.has_sample(c, r) ? 1 : 0;
  samples.neighbours = [&](std::uint32_t i, std::vector<std::uint32_t>& out) {
    out.clear();
    const int column = static_cast<int>(i) % grid.columns, row = static_cast<int>(i) / grid.columns;
    for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(grid.columns - 1, column + 1); ++c)
        if (const std::uint32_t j = index(c, r); j != i && samples.usable[j] != 0) out.push_back(j);
  };
  std::vector<std::uint32_t> around;
  for (std::uint32_t i = 0; i < n; ++i) {
    samples.neighbours(i, around);
    samples.border[i] = around.size() < 8 ? 1 : 0;
  }
  const Place place = [&](std::uint32_t i) {
    return refined(grid, static_cast<int>(i) % grid.columns, static_cast<int>(i) / grid.columns);
  };
  return find(samples, prominence, place, context);
}

std::vector<SpotHeight> find_spot_heights(const Terrain& terrain, double prominence, const Context& context) {
  check(prominence);
  const Tin& tin = terrain.tin;
  const EdgeTable edges = build_edges(tin);
  Samples samples;
  const std::size_t n = tin.vertex_count();
  samples.heights = tin.heights;
  samples.usable.assign(n, 1);
  samples.border.assign(n, 0);
  std::vector<std::size_t> starts(n + 1, 0);
  for (const auto& e : edges.vertices) ++starts[e[0] + 1], ++starts[e[1] + 1];
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<std::uint32_t> ends(starts.back());
  std::vector<std::size_t> at(starts.begin(), starts.end() - 1);
  for (std::size_t k = 0; k < edges.vertices.size(); ++k) {
    const auto& e = edges.vertices[k];
    ends[at[e[0]]++] = e[1];
    ends[at[e[1]]++] = e[0];
    if (edges.triangles[k][1] == kNone) samples.border[e[0]] = samples.border[e[1]] = 1;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (terrain.grid.columns > 0 && !terrain.grid.has_data(tin.points[i])) samples.border[i] = 1;
    std::sort(ends.begin() + static_cast<std::ptrdiff_t>(starts[i]),
              ends.begin() + static_cast<std::ptrdiff_t>(starts[i + 1]));
  }
  samples.neighbours = [&](std::uint32_t i, std::vector<std::uint32_t>& out) {
    out.assign(ends.begin() + static_cast<std::ptrdiff_t>(starts[i]),
               ends.begin() + static_cast<std::ptrdiff_t>(starts[i + 1]));
  };
  const Place place = [&](std::uint32_t i) { return SpotHeight{tin.points[i], tin.heights[i]}; };
  return find(samples, prominence, place, context);
}

double spot_prominence(const std::vector<double>& levels, double low, double high) {
  if (levels.size() > 1) return (levels.back() - levels.front()) / static_cast<double>(levels.size() - 1);
  return high > low ? (high - low) / 20 : 1;
}

}  // namespace retalho
