#include "retalho/patch/domain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/patch/sides.h"
#include "retalho/tin/scattered.h"

namespace retalho {
namespace {

void check_count(std::size_t n) {
  if (n < 1 || n > 10000)
    throw UsageError(fmt::format("{} divisions of a side: 1 to 10000 are possible", n), {}, "--divisions");
}

double fraction(std::size_t k, std::size_t n) {
  return static_cast<double>(k) / static_cast<double>(n);
}

/// Side nodes by what lies exactly on the sides, in order along them.
void collect_sides(Domain& domain) {
  for (int side = 0; side < 3; ++side) {
    auto& nodes = domain.sides[static_cast<std::size_t>(side)];
    for (std::uint32_t i = 0; i < domain.parameters.size(); ++i) {
      const Vec2 p = domain.parameters[i];
      if (side == 0 ? p.x + p.y == 1 : side == 1 ? p.x == 0 : p.y == 0) nodes.push_back(i);
    }
    std::sort(nodes.begin(), nodes.end(), [&](std::uint32_t a, std::uint32_t b) {
      return side_argument(side, domain.parameters[a]) < side_argument(side, domain.parameters[b]);
    });
  }
}

/// Delaunay in nearly equilateral coordinates whose arithmetic is exact for parameters of 40 bits: the nodes of a side
/// are then on one line for the exact predicates, and no sliver is cut off.
Domain delaunay_domain(const std::array<std::size_t, 3>& counts, const Context& context) {
  const auto rounded = [](double x) { return std::ldexp(std::nearbyint(std::ldexp(x, 40)), -40); };
  std::vector<Vec2> nodes;
  for (int side = 0; side < 3; ++side) {
    const std::size_t n = counts[static_cast<std::size_t>(side)];
    for (std::size_t k = 0; k < n; ++k) nodes.push_back(side_parameters(side, rounded(fraction(k, n))));
  }
  const std::size_t mean = (counts[0] + counts[1] + counts[2] + 1) / 3;
  for (std::size_t i = 1; i < mean; ++i)
    for (std::size_t j = 1; i + j < mean; ++j)
      nodes.push_back({rounded(fraction(i, mean)), rounded(fraction(j, mean))});
  std::vector<Vec3> places;
  places.reserve(nodes.size());
  for (const Vec2& p : nodes) places.push_back({p.x + p.y / 2, p.y * 0.875, 0});
  const Tin tin = triangulate_points(places, nullptr, context);
  Domain domain;
  for (const Vec2& p : tin.points) {
    const double v = p.y / 0.875;  // exact: p.y is v * 7/8 without rounding
    domain.parameters.push_back({p.x - v / 2, v});
  }
  domain.triangles = tin.triangles;
  collect_sides(domain);
  return domain;
}

/// Three grids about the midpoint. Spoke i, from side i to the midpoint, has m[i] edges; then side i has
/// m[i + 1] + m[i + 2] of them, cut m[i + 2] edges after its start.
Domain midpoint_domain(const std::array<std::size_t, 3>& counts) {
  const std::size_t sum = counts[0] + counts[1] + counts[2];
  std::array<std::size_t, 3> m{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (sum % 2 != 0 || sum <= 2 * counts[i])
      throw UsageError(fmt::format("divisions {}, {}, {}: the midpoint layout asks for an even sum and for each count "
                                   "under the sum of the other two; the delaunay layout takes any",
                                   counts[0], counts[1], counts[2]),
                       {}, "--divisions");
    m[i] = sum / 2 - counts[i];
  }
  Domain domain;
  const auto add = [&](Vec2 p) {
    domain.parameters.push_back(p);
    return static_cast<std::uint32_t>(domain.parameters.size() - 1);
  };
  std::array<std::vector<std::uint32_t>, 3> along, spoke;
  for (std::size_t side = 0; side < 3; ++side)
    for (std::size_t k = 0; k < counts[side]; ++k)
      along[side].push_back(add(side_parameters(static_cast<int>(side), fraction(k, counts[side]))));
  for (std::size_t side = 0; side < 3; ++side) along[side].push_back(along[(side + 1) % 3][0]);
  std::array<Vec2, 3> cut;
  Vec2 middle{};
  for (std::size_t i = 0; i < 3; ++i) {
    cut[i] = domain.parameters[along[i][m[(i + 2) % 3]]];
    middle = middle + cut[i] / 3;
  }
  const std::uint32_t centre = add(middle);
  for (std::size_t i = 0; i < 3; ++i) {
    spoke[i].push_back(along[i][m[(i + 2) % 3]]);
    for (std::size_t k = 1; k < m[i]; ++k) spoke[i].push_back(add(cut[i] + fraction(k, m[i]) * (middle - cut[i])));
    spoke[i].push_back(centre);
  }
  for (std::size_t c = 0; c < 3; ++c) {  // corner c: side c leaves it, side `in` arrives
    const std::size_t in = (c + 2) % 3, columns = m[in], rows = m[c];
    const Vec2 corner = domain.parameters[along[c][0]];
    std::vector<std::uint32_t> row, before;
    for (std::size_t y = 0; y <= rows; ++y) {
      row.clear();
      for (std::size_t x = 0; x <= columns; ++x) {
        const double a = fraction(x, columns), b = fraction(y, rows);
        if (y == 0)
          row.push_back(along[c][x]);
        else if (x == 0)
          row.push_back(along[in][counts[in] - y]);
        else if (x == columns)
          row.push_back(spoke[c][y]);
        else if (y == rows)
          row.push_back(spoke[in][x]);
        else
          row.push_back(
              add((1 - a) * (1 - b) * corner + a * (1 - b) * cut[c] + (1 - a) * b * cut[in] + a * b * middle));
        if (x > 0 && y > 0) {
          domain.triangles.push_back({before[x - 1], before[x], row[x]});
          domain.triangles.push_back({before[x - 1], row[x], row[x - 1]});
        }
      }
      before = row;
    }
  }
  domain.sides = along;
  return domain;
}

}  // namespace

Domain regular_domain(std::size_t n) {
  check_count(n);
  Domain domain;
  domain.parameters.reserve((n + 1) * (n + 2) / 2);
  domain.triangles.reserve(n * n);
  const auto node = [n](std::size_t i, std::size_t j) {  // rows before row i have n + 1, n, ... nodes
    return static_cast<std::uint32_t>(i * (n + 1) - i * (i + 1) / 2 + i + j);
  };
  for (std::size_t i = 0; i <= n; ++i)
    for (std::size_t j = 0; i + j <= n; ++j) {
      Vec2 p{fraction(i, n), fraction(j, n)};
      if (i + j == n) p.x = 1 - p.y;
      domain.parameters.push_back(p);
      if (i + j >= n) continue;
      domain.triangles.push_back({node(i, j), node(i + 1, j), node(i, j + 1)});
      if (i + j + 1 < n) domain.triangles.push_back({node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
    }
  for (std::size_t k = 0; k <= n; ++k) {
    domain.sides[0].push_back(node(n - k, k));
    domain.sides[1].push_back(node(0, n - k));
    domain.sides[2].push_back(node(k, 0));
  }
  return domain;
}

Domain make_domain(const std::array<std::size_t, 3>& counts, DomainLayout layout, const Context& context) {
  for (const std::size_t n : counts) check_count(n);
  if (counts[0] == counts[1] && counts[1] == counts[2]) return regular_domain(counts[0]);
  return layout == DomainLayout::midpoint ? midpoint_domain(counts) : delaunay_domain(counts, context);
}

}  // namespace retalho
