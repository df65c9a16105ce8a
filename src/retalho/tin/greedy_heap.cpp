#include "retalho/tin/greedy_heap.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "retalho/tin/grid_hull.h"

namespace retalho {
namespace {

struct Cell {
  std::int64_t x, y;  // column, row
  friend bool operator==(const Cell&, const Cell&) = default;
};

std::int64_t area2(Cell a, Cell b, Cell c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Is d strictly inside the circle through a, b, c (area2 > 0)? Exact.
bool in_circle(Cell a, Cell b, Cell c, Cell d) {
  using Wide = __int128;
  const std::int64_t ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
  const Wide value = Wide(ax * ax + ay * ay) * (bx * cy - by * cx) + Wide(bx * bx + by * by) * (cx * ay - cy * ax) +
                     Wide(cx * cx + cy * cy) * (ax * by - ay * bx);
  return value > 0;
}

class Refinement {
 public:
  Refinement(const Raster& raster, const RefineOptions& options, const Context& context)
      : raster_(raster), options_(options), context_(context) {}

  GridTin run() {
    start();
    const bool budget = options_.vertices > 0;
    const double tolerance = budget && options_.max_error <= 0 ? 0 : options_.max_error;
    if (!budget) refine_sides(tolerance);
    for (std::size_t step = 0; !heap_.empty() && !(budget && vertices_ >= options_.vertices); ++step) {
      if (step % 1024 == 0) context_.check();
      const Entry e = heap_.top();
      heap_.pop();
      if (e.stamp != stamp_[e.triangle]) continue;
      if (!over(e.triangle, tolerance)) continue;
      insert(candidate_[e.triangle], e.triangle);
    }
    return result();
  }

 private:
  struct Entry {
    double error;
    std::int64_t cell;
    std::uint32_t triangle, stamp;
    bool operator<(const Entry& o) const { return error != o.error ? error < o.error : cell > o.cell; }
  };

  double height(Cell c) const { return raster_.at(static_cast<int>(c.x), static_cast<int>(c.y)); }
  bool over(std::uint32_t t, double tolerance) const {
    return scaled_[t] > tolerance * static_cast<double>(area2(corner_[t][0], corner_[t][1], corner_[t][2]));
  }

  void start() {
    std::vector<Cell> hull;
    for (const greedy::Cell c : greedy::hull_of_valid(raster_)) hull.push_back(unpack(c));
    vertices_ = hull.size();
    for (std::size_t i = 1; i + 1 < hull.size(); ++i) add({hull[0], hull[i], hull[i + 1]});
    const auto n = static_cast<std::uint32_t>(corner_.size());
    // Edge k is opposite corner k: of (h0, hi, hi+1), edge 0 is the hull's, edge 1 is (hi+1, h0), edge 2 is (h0, hi).
    for (std::uint32_t t = 0; t < n; ++t) {
      link_[t] = {kNone, t + 1 < n ? t + 1 : kNone, t > 0 ? t - 1 : kNone};
    }
    for (bool changed = true; changed;) {  // a fan of hull corners: few triangles, plain flips will do
      changed = false;
      for (std::uint32_t t = 0; t < n; ++t)
        for (std::size_t k = 0; k < 3; ++k)
          if (link_[t][k] != kNone && flip_if_needed(t, k)) changed = true;
    }
    for (std::uint32_t t = 0; t < n; ++t) scan(t);
  }

  bool flip_if_needed(std::uint32_t t, std::size_t k) {
    const std::uint32_t u = link_[t][k];
    std::size_t m = 0;
    while (link_[u][m] != t) ++m;
    const Cell p = corner_[t][k], a = corner_[t][(k + 1) % 3], b = corner_[t][(k + 2) % 3], q = corner_[u][m];
    if (!in_circle(p, a, b, q)) return false;
    const std::uint32_t ta = link_[t][(k + 1) % 3], tb = link_[t][(k + 2) % 3];  // across (b, p) and (p, a)
    const std::uint32_t ua = link_[u][(m + 1) % 3], ub = link_[u][(m + 2) % 3];  // across (a, q) and (q, b)
    corner_[t] = {p, a, q};
    link_[t] = {ua, u, tb};
    corner_[u] = {p, q, b};
    link_[u] = {ub, ta, t};
    relink(ua, u, t);
    relink(ta, t, u);
    return true;
  }

  void relink(std::uint32_t t, std::uint32_t from, std::uint32_t to) {
    if (t == kNone) return;
    for (auto& l : link_[t])
      if (l == from) {
        l = to;
        return;
      }
  }

  std::uint32_t add(const std::array<Cell, 3>& corners) {
    corner_.push_back(corners);
    link_.push_back({kNone, kNone, kNone});
    candidate_.push_back({});
    scaled_.push_back(0);
    stamp_.push_back(0);
    return static_cast<std::uint32_t>(corner_.size() - 1);
  }

  /// The worst cell of a triangle, edges included; ties: the lowest row-major cell.
  void scan(std::uint32_t t) {
    const auto& [a, b, c] = corner_[t];
    const std::int64_t area = area2(a, b, c);
    const double za = height(a),
                 gx = (height(b) - za) * static_cast<double>(c.y - a.y) -
                      (height(c) - za) * static_cast<double>(b.y - a.y),
                 gy = (height(c) - za) * static_cast<double>(b.x - a.x) -
                      (height(b) - za) * static_cast<double>(c.x - a.x);
    double worst = 0;
    Cell at{};
    const std::int64_t y0 = std::min({a.y, b.y, c.y}), y1 = std::max({a.y, b.y, c.y});
    for (std::int64_t y = y0; y <= y1; ++y) {
      std::int64_t x0 = std::min({a.x, b.x, c.x}), x1 = std::max({a.x, b.x, c.x});
      for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
        // inside: (q.x - p.x) (y - p.y) - (q.y - p.y) (x - p.x) >= 0
        const std::int64_t dy = q.y - p.y, r = (q.x - p.x) * (y - p.y);
        if (dy > 0) x1 = std::min(x1, p.x + floor_div(r, dy));
        if (dy < 0) x0 = std::max(x0, p.x - floor_div(r, -dy));
        if (dy == 0 && r < 0) x1 = x0 - 1;
      }
      for (std::int64_t x = x0; x <= x1; ++x) {
        const double z = height({x, y});
        const double error = std::abs((z - za) * static_cast<double>(area) -
                                      (gx * static_cast<double>(x - a.x) + gy * static_cast<double>(y - a.y)));
        if (error > worst) {  // NaN never is
          worst = error;
          at = {x, y};
        }
      }
    }
    scaled_[t] = worst;
    candidate_[t] = at;
    ++stamp_[t];
    if (worst > 0) heap_.push({worst / static_cast<double>(area), at.y * raster_.columns + at.x, t, stamp_[t]});
  }

  static std::int64_t floor_div(std::int64_t a, std::int64_t b) {
    const std::int64_t q = a / b;
    return q - (a % b != 0 && (a < 0) != (b < 0) ? 1 : 0);
  }

  /// Inserts a cell that lies in triangle `t` (or on its border): the cavity is opened and its star written.
  void insert(Cell p, std::uint32_t t) {
    ring_.clear();
    inside_.assign(1, t);
    // Depth first in order, so that the ring comes out connected.
    collect(p, t, 3);
    ++vertices_;
    std::vector<std::uint32_t> made;
    std::size_t reuse = 0;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const auto& [a, b, outside] = ring_[i];
      if (area2(p, a, b) == 0) {  // p lies on this border edge: the fan opens here
        made.push_back(kNone);
        continue;
      }
      const std::uint32_t id = reuse < inside_.size() ? inside_[reuse++] : add({});
      corner_[id] = {p, a, b};
      link_[id] = {outside, kNone, kNone};
      if (outside != kNone) {
        for (std::size_t m = 0; m < 3; ++m)
          if (corner_[outside][(m + 1) % 3] == b && corner_[outside][(m + 2) % 3] == a) link_[outside][m] = id;
      }
      made.push_back(id);
    }
    for (std::size_t i = 0; i < made.size(); ++i) {
      const std::uint32_t id = made[i], next = made[(i + 1) % made.size()];
      if (id != kNone) link_[id][1] = next;  // across (b, p)
      if (next != kNone) link_[next][2] = id;
    }
    for (const std::uint32_t id : made)
      if (id != kNone) scan(id);
  }

  struct RingEdge {
    Cell a, b;
    std::uint32_t outside;
  };

  void collect(Cell p, std::uint32_t t, std::size_t from) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = from == 3 ? i : (from + 1 + i) % 3;
      if (from != 3 && i == 2) break;
      const std::uint32_t u = link_[t][k];
      if (u != kNone && std::find(inside_.begin(), inside_.end(), u) == inside_.end() &&
          in_circle(corner_[u][0], corner_[u][1], corner_[u][2], p)) {
        inside_.push_back(u);
        std::size_t m = 0;
        while (link_[u][m] != t) ++m;
        collect(p, u, m);
      } else {
        ring_.push_back({corner_[t][(k + 1) % 3], corner_[t][(k + 2) % 3], u});
      }
    }
  }

  /// Hull sides along the grid's own border are refined by themselves first: their vertices depend on that row or
  /// column alone, so neighbouring grids that share it agree.
  void refine_sides(double tolerance) {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::uint32_t t = 0; t < corner_.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
          if (link_[t][k] != kNone) continue;
          const Cell a = corner_[t][(k + 1) % 3], b = corner_[t][(k + 2) % 3];
          if (!greedy::on_side(pack(a), pack(b), raster_.columns, raster_.rows)) continue;
          const Cell worst = unpack(greedy::worst_on_side(raster_, pack(a), pack(b), tolerance));
          if (worst == a) continue;
          insert(worst, t);
          changed = true;
          break;
        }
    }
  }

  GridTin result() const {
    GridTin tin;
    tin.cells.reserve(vertices_);
    for (const auto& t : corner_)
      for (const Cell c : t) tin.cells.push_back(pack(c));
    std::sort(tin.cells.begin(), tin.cells.end());
    tin.cells.erase(std::unique(tin.cells.begin(), tin.cells.end()), tin.cells.end());
    const auto number = [&](Cell c) {
      return static_cast<std::uint32_t>(std::lower_bound(tin.cells.begin(), tin.cells.end(), pack(c)) -
                                        tin.cells.begin());
    };
    for (std::size_t t = 0; t < corner_.size(); ++t) {
      // Rows run south, so what turns left in (column, row) turns right seen from above: the order is reversed.
      tin.triangles.push_back({number(corner_[t][0]), number(corner_[t][2]), number(corner_[t][1])});
      tin.neighbors.push_back({link_[t][0], link_[t][2], link_[t][1]});
      const double area = static_cast<double>(area2(corner_[t][0], corner_[t][1], corner_[t][2]));
      tin.max_error = std::max(tin.max_error, scaled_[t] / area);
    }
    return tin;
  }

  static Cell unpack(greedy::Cell c) { return {greedy::column_of(c), greedy::row_of(c)}; }
  static std::uint32_t pack(Cell c) { return static_cast<std::uint32_t>(c.y << 16 | c.x); }

  const Raster& raster_;
  const RefineOptions& options_;
  const Context& context_;
  std::vector<std::array<Cell, 3>> corner_;         // area2 > 0 in (column, row)
  std::vector<std::array<std::uint32_t, 3>> link_;  // across the edge opposite each corner
  std::vector<Cell> candidate_;
  std::vector<double> scaled_;        // the worst error times the doubled area
  std::vector<std::uint32_t> stamp_;  // heap entries of another stamp are out of date
  std::priority_queue<Entry> heap_;
  std::vector<RingEdge> ring_;
  std::vector<std::uint32_t> inside_;
  std::size_t vertices_ = 0;
};

}  // namespace

GridTin refine_grid_by_heap(const Raster& raster, const RefineOptions& options, const Context& context) {
  return Refinement(raster, options, context).run();
}

}  // namespace retalho
