#include "retalho/patch/vertex_fit.h"

#include <algorithm>
#include <cmath>

#include "retalho/core/parallel.h"
#include "retalho/patch/small_fit.h"
#include "retalho/patch/topology.h"

namespace retalho {
namespace {

constexpr std::size_t kWanted = 18, kMost = 60;  ///< nodes of a fit beside its own: at first, and at last
constexpr double kCondition = 1e4;

std::array<double, 9> monomials(double a, double b) {
  return {a, b, a * a, a * b, b * b, a * a * a, a * a * b, a * b * b, b * b * b};
}

/// What a node's sides fix: the directions and where the tangents stand.
struct Fixed {
  int count = 0;
  std::array<Vec2, 2> direction;
  std::array<std::uint32_t, 2> tangent{};
};

struct Row {
  VertexFrame frame;
  std::vector<std::uint32_t> sources;
  std::vector<std::array<double, 9>> columns;
};

/// Fits one node over `points` (the node itself first). Returns the condition.
double fit(const Domain& domain, const std::vector<std::uint32_t>& points, const Fixed& fixed, SmallFit& solver,
           std::vector<double>& inverse, Row& row) {
  const Vec2 origin = domain.parameters[points[0]];
  const std::size_t m = points.size() - 1, known = static_cast<std::size_t>(fixed.count), n = 9 - known;
  double h = 0;
  for (std::size_t i = 1; i <= m; ++i) h = std::max(h, norm(domain.parameters[points[i]] - origin));
  row.frame.h = h;
  row.frame.t = fixed.count == 1 ? fixed.direction[0] / norm(fixed.direction[0]) : Vec2{1, 0};
  const Vec2 t = row.frame.t, normal{-t.y, t.x};
  solver.resize(m, n);
  std::vector<std::array<double, 9>> terms(m);
  std::vector<double> weight(m);
  for (std::size_t i = 0; i < m; ++i) {
    const Vec2 d = (domain.parameters[points[i + 1]] - origin) / h;
    const double r = norm(d);
    weight[i] = std::exp(-3 * r * r) / (r * r);
    terms[i] = monomials(dot(t, d), dot(normal, d));
    for (std::size_t j = 0; j < n; ++j) solver.at(i, j) = weight[i] * terms[i][j + known];
  }
  const double condition = solver.factor();
  if (!std::isfinite(condition)) return condition;
  solver.pseudo_inverse(inverse);
  row.sources.assign(points.begin() + 1, points.end());
  row.columns.assign(m, {});
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < n; ++j) row.columns[i][j + known] = inverse[j * m + i] * weight[i];
  if (known == 0) return condition;
  // The known linear terms as multiples of the tangents: K.
  std::array<std::array<double, 2>, 2> k{};  // k[term][tangent]
  if (known == 1) {
    k[0][0] = h / norm(fixed.direction[0]);
  } else {  // d1 . g = T1, d2 . g = T2
    const double det = cross(fixed.direction[0], fixed.direction[1]);
    k[0] = {h * fixed.direction[1].y / det, -h * fixed.direction[0].y / det};
    k[1] = {-h * fixed.direction[1].x / det, h * fixed.direction[0].x / det};
  }
  for (std::size_t tangent = 0; tangent < known; ++tangent) {
    std::array<double, 9> column{};
    for (std::size_t j = 0; j < known; ++j) column[j] = k[j][tangent];
    for (std::size_t i = 0; i < m; ++i) {  // what the known terms say at the points is taken from the data
      double said = 0;
      for (std::size_t j = 0; j < known; ++j) said += terms[i][j] * k[j][tangent];
      for (std::size_t j = known; j < 9; ++j) column[j] -= row.columns[i][j] * said;
    }
    row.sources.push_back(0x80000000U + fixed.tangent[tangent]);
    row.columns.push_back(column);
  }
  return condition;
}

/// Too few nodes for a cubic: the gradient alone, or what the sides fix of it.
void fit_gradient(const Domain& domain, const std::vector<std::uint32_t>& points, const Fixed& fixed, Row& row) {
  const Vec2 origin = domain.parameters[points[0]];
  row = {};
  row.frame.t = fixed.count == 1 ? fixed.direction[0] / norm(fixed.direction[0]) : Vec2{1, 0};
  const Vec2 t = row.frame.t, normal{-t.y, t.x};
  if (fixed.count == 2) {
    const double det = cross(fixed.direction[0], fixed.direction[1]);
    row.sources = {0x80000000U + fixed.tangent[0], 0x80000000U + fixed.tangent[1]};
    row.columns.assign(2, {});
    row.columns[0][0] = fixed.direction[1].y / det, row.columns[0][1] = -fixed.direction[1].x / det;
    row.columns[1][0] = -fixed.direction[0].y / det, row.columns[1][1] = fixed.direction[0].x / det;
    return;
  }
  double aa = 0, ab = 0, bb = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2 d = domain.parameters[points[i]] - origin;
    const double a = dot(t, d), b = dot(normal, d);
    aa += a * a, ab += a * b, bb += b * b;
  }
  row.sources.assign(points.begin() + 1, points.end());
  row.columns.assign(row.sources.size(), {});
  std::array<double, 9> tangent{};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2 d = domain.parameters[points[i]] - origin;
    const double a = dot(t, d), b = dot(normal, d);
    auto& column = row.columns[i - 1];
    if (fixed.count == 1) {
      column[1] = b / bb;
      tangent[1] -= column[1] * a / norm(fixed.direction[0]);
    } else {
      const double det = aa * bb - ab * ab;
      column[0] = (bb * a - ab * b) / det, column[1] = (aa * b - ab * a) / det;
    }
  }
  if (fixed.count == 0) return;
  tangent[0] = 1 / norm(fixed.direction[0]);
  row.sources.push_back(0x80000000U + fixed.tangent[0]);
  row.columns.push_back(tangent);
}

}  // namespace

std::array<Vec3, 2> gradient(const VertexFrame& frame, const VertexCubic& c, Vec2 d) {
  const Vec2 t = frame.t, n{-t.y, t.x};
  const double a = dot(t, d) / frame.h, b = dot(n, d) / frame.h;
  const Vec3 by_a = (c[0] + 2 * a * c[2] + b * c[3] + 3 * a * a * c[5] + 2 * a * b * c[6] + b * b * c[7]) / frame.h;
  const Vec3 by_b = (c[1] + a * c[3] + 2 * b * c[4] + a * a * c[6] + 2 * a * b * c[7] + 3 * b * b * c[8]) / frame.h;
  return {t.x * by_a + n.x * by_b, t.y * by_a + n.y * by_b};
}

VertexFit::VertexFit(const Domain& domain, const Context& context) {
  const std::size_t count = domain.parameters.size();
  std::vector<Fixed> fixed(count);
  std::uint32_t slot = 0;
  for (int side = 0; side < 3; ++side)
    for (const std::uint32_t v : domain.sides[static_cast<std::size_t>(side)]) {
      Fixed& f = fixed[v];
      f.direction[static_cast<std::size_t>(f.count)] = side_direction(side);
      f.tangent[static_cast<std::size_t>(f.count)] = slot++;
      ++f.count;
    }
  const VertexNeighbors around = vertex_neighbors(domain.triangles, count);
  constexpr std::size_t kGrain = 1024;
  std::vector<std::vector<Row>> chunks((count + kGrain - 1) / kGrain);
  frames_.resize(count);
  first_.assign(count + 1, 0);
  parallel_chunks(count, kGrain, context, [&](std::size_t begin, std::size_t end) {
    Rings rings(around.first, around.vertices);
    SmallFit solver;
    std::vector<double> inverse;
    std::vector<Row>& rows = chunks[begin / kGrain];
    rows.resize(end - begin);
    for (std::size_t v = begin; v < end; ++v) {
      Row& row = rows[v - begin];
      std::size_t wanted = kWanted;
      double condition = INFINITY;
      for (;;) {
        const auto& points = rings.grow({static_cast<std::uint32_t>(v)}, wanted, 1 << 20);
        condition = fit(domain, points, fixed[v], solver, inverse, row);
        if (condition < kCondition || points.size() - 1 >= kMost || points.size() - 1 < wanted) break;
        wanted = points.size();  // one ring more
      }
      if (!(condition < 1e3 * kCondition))
        fit_gradient(domain, rings.grow({static_cast<std::uint32_t>(v)}, 1, 1), fixed[v], row);
      frames_[v] = row.frame;
      first_[v + 1] = row.sources.size();
    }
  });
  for (std::size_t v = 0; v < count; ++v) first_[v + 1] += first_[v];
  sources_.reserve(first_[count]);
  columns_.reserve(first_[count]);
  for (std::vector<Row>& rows : chunks) {
    for (const Row& row : rows) {
      sources_.insert(sources_.end(), row.sources.begin(), row.sources.end());
      columns_.insert(columns_.end(), row.columns.begin(), row.columns.end());
    }
    rows = {};
  }
}

VertexCubic VertexFit::cubic(std::size_t vertex, const std::vector<Vec3>& positions,
                             const std::vector<Vec3>& tangents) const {
  VertexCubic c{};
  const Vec3 own = positions[vertex];
  for (std::size_t k = first_[vertex]; k < first_[vertex + 1]; ++k) {
    const std::uint32_t s = sources_[k];
    const Vec3 value = s >= kTangent ? tangents[s - kTangent] : positions[s] - own;
    for (std::size_t j = 0; j < 9; ++j) c[j] = c[j] + columns_[k][j] * value;
  }
  return c;
}

std::vector<Vec3> VertexFit::tangents(const Domain& domain, const PatchSides& sides) const {
  std::vector<Vec3> out;
  for (int side = 0; side < 3; ++side)
    for (const std::uint32_t v : domain.sides[static_cast<std::size_t>(side)])
      out.push_back(sides[static_cast<std::size_t>(side)].jet(side_argument(side, domain.parameters[v])).first);
  return out;
}

}  // namespace retalho
