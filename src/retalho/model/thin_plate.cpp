#include "retalho/model/thin_plate.h"

#include <algorithm>
#include <cmath>

namespace retalho {
namespace {

/// The three cubic pieces of a triangle: piece k has corners k + 1, k + 2 and the centroid, and ten ordinates
/// 300 210 201 120 111 102 030 021 012 003.
using Net = std::array<double, 10>;
using Pieces = std::array<Net, 3>;

Pieces pieces_of(const std::array<Vec2, 3>& v, const std::array<VertexJet, 3>& u) {
  const Vec2 c{(v[0].x + v[1].x + v[2].x) / 3, (v[0].y + v[1].y + v[2].y) / 3};
  const auto towards = [&](std::size_t i, Vec2 q) {
    return u[i][0] + ((q.x - v[i].x) * u[i][1] + (q.y - v[i].y) * u[i][2]) / 3;
  };
  std::array<double, 3> spoke{}, face{}, inner{}, first{}, second{};
  for (std::size_t i = 0; i < 3; ++i) spoke[i] = towards(i, c);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    first[k] = towards(i, v[j]);
    second[k] = towards(j, v[i]);
    const double ex = v[j].x - v[i].x, ey = v[j].y - v[i].y;
    const double t = ((c.x - v[i].x) * ex + (c.y - v[i].y) * ey) / (ex * ex + ey * ey);
    face[k] =
        (spoke[i] + spoke[j] + (t - 1) * u[i][0] + (2 - 3 * t) * first[k] + (3 * t - 1) * second[k] - t * u[j][0]) / 2;
  }
  for (std::size_t i = 0; i < 3; ++i) inner[i] = (spoke[i] + face[(i + 1) % 3] + face[(i + 2) % 3]) / 3;
  const double centre = (inner[0] + inner[1] + inner[2]) / 3;
  Pieces result;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    result[k] = {u[i][0], first[k], spoke[i], second[k], face[k], inner[i], u[j][0], spoke[j], inner[j], centre};
  }
  return result;
}

double cross_of(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Second derivatives xx, xy, yy at the three corners of a piece: they are linear on it.
using Second = std::array<std::array<double, 3>, 3>;

struct PieceFrame {
  std::array<double, 3> dx, dy;  // of the barycentric coordinates
  double area = 0;

  PieceFrame(Vec2 a, Vec2 b, Vec2 c) {
    const double twice = cross_of(a, b, c);
    area = twice / 2;
    dx = {(b.y - c.y) / twice, (c.y - a.y) / twice, (a.y - b.y) / twice};
    dy = {(c.x - b.x) / twice, (a.x - c.x) / twice, (b.x - a.x) / twice};
  }
  Second second(const Net& n) const {
    // The six ordinates of each corner's second differences: b + e_i + e_j for the corner's own index added once.
    static constexpr int kOf[3][3][3] = {
        {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}, {{1, 3, 4}, {3, 6, 7}, {4, 7, 8}}, {{2, 4, 5}, {4, 7, 8}, {5, 8, 9}}};
    Second result{};
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          const double b = 6 * n[static_cast<std::size_t>(kOf[corner][i][j])];
          result[corner][0] += dx[i] * dx[j] * b;
          result[corner][1] += dx[i] * dy[j] * b;
          result[corner][2] += dy[i] * dy[j] * b;
        }
    return result;
  }
};

using Matrix9 = std::array<std::array<double, 9>, 9>;

Matrix9 bending_of(const std::array<Vec2, 3>& v) {
  const Vec2 c{(v[0].x + v[1].x + v[2].x) / 3, (v[0].y + v[1].y + v[2].y) / 3};
  std::array<std::array<Second, 3>, 9> of{};  // of each unknown, in each piece
  std::array<double, 3> area{};
  for (std::size_t u = 0; u < 9; ++u) {
    std::array<VertexJet, 3> one{};
    one[u / 3][u % 3] = 1;
    const Pieces pieces = pieces_of(v, one);
    for (std::size_t k = 0; k < 3; ++k) {
      const PieceFrame frame(v[(k + 1) % 3], v[(k + 2) % 3], c);
      of[u][k] = frame.second(pieces[k]);
      area[k] = frame.area;
    }
  }
  Matrix9 m{};
  for (std::size_t a = 0; a < 9; ++a)
    for (std::size_t b = 0; b < 9; ++b)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t d = 0; d < 3; ++d) {
          // The integral of a product of linear functions: (sum f sum g + sum fg) area / 12.
          double f = 0, g = 0, fg = 0;
          for (std::size_t q = 0; q < 3; ++q) {
            f += of[a][k][q][d];
            g += of[b][k][q][d];
            fg += of[a][k][q][d] * of[b][k][q][d];
          }
          m[a][b] += (d == 1 ? 2 : 1) * (f * g + fg) * area[k] / 12;
        }
  return m;
}

}  // namespace

double clough_tocher_height(const std::array<Vec2, 3>& v, const std::array<VertexJet, 3>& data, Vec2 p) {
  const double twice = cross_of(v[0], v[1], v[2]);
  const std::array<double, 3> at{cross_of(v[1], v[2], p) / twice, cross_of(v[2], v[0], p) / twice,
                                 cross_of(v[0], v[1], p) / twice};
  const std::size_t k = at[2] < std::min(at[0], at[1]) ? 2 : at[1] < at[0] ? 1 : 0;
  const double r = at[(k + 1) % 3] - at[k], s = at[(k + 2) % 3] - at[k], t = 3 * at[k];
  const Net n = pieces_of(v, data)[k];
  return n[0] * r * r * r + 3 * r * r * (n[1] * s + n[2] * t) +
         3 * r * (n[3] * s * s + 2 * n[4] * s * t + n[5] * t * t) + n[6] * s * s * s +
         3 * s * t * (n[7] * s + n[8] * t) + n[9] * t * t * t;
}

void facet_gradients(std::span<const Vec2> points, IndexTriangles triangles, std::span<const std::uint8_t> folded,
                     std::vector<VertexJet>& data) {
  std::vector<double> area(data.size(), 0.0);
  std::vector<std::uint8_t> smooth(data.size(), 0);  // has a triangle without a folded corner
  const auto has_fold = [&](const std::array<std::uint32_t, 3>& t) {
    return !folded.empty() && (folded[t[0]] != 0 || folded[t[1]] != 0 || folded[t[2]] != 0);
  };
  for (const auto& t : triangles)
    if (!has_fold(t))
      for (const std::uint32_t v : t) smooth[v] = 1;
  for (VertexJet& u : data) u[1] = u[2] = 0;
  for (const auto& t : triangles) {
    const bool fold = has_fold(t);
    const Vec2 a = points[t[0]], b = points[t[1]], c = points[t[2]];
    const double zb = data[t[1]][0] - data[t[0]][0], zc = data[t[2]][0] - data[t[0]][0];
    const double gx = zb * (c.y - a.y) - zc * (b.y - a.y), gy = zc * (b.x - a.x) - zb * (c.x - a.x);
    const double twice = cross_of(a, b, c);
    for (const std::uint32_t v : t) {
      if (fold && smooth[v] != 0) continue;
      area[v] += twice;
      data[v][1] += gx;
      data[v][2] += gy;
    }
  }
  for (std::size_t v = 0; v < data.size(); ++v) {
    if (!(area[v] > 0)) continue;
    data[v][1] /= area[v];
    data[v][2] /= area[v];
  }
}

void fold_jets(const std::array<Vec2, 3>& v, const std::array<bool, 3>& folded, std::array<VertexJet, 3>& data) {
  if (!folded[0] && !folded[1] && !folded[2]) return;
  const double zb = data[1][0] - data[0][0], zc = data[2][0] - data[0][0], twice = cross_of(v[0], v[1], v[2]);
  const double gx = (zb * (v[2].y - v[0].y) - zc * (v[1].y - v[0].y)) / twice;
  const double gy = (zc * (v[1].x - v[0].x) - zb * (v[2].x - v[0].x)) / twice;
  for (std::size_t k = 0; k < 3; ++k)
    if (folded[k]) data[k] = {data[k][0], gx, gy};
}

Bending::Bending(std::span<const Vec2> points, IndexTriangles triangles, std::span<const std::uint8_t> folded)
    : count_(points.size()), begin_(count_ + 1, 0) {
  std::vector<std::vector<std::uint32_t>> rows(count_);
  for (std::uint32_t v = 0; v < count_; ++v) rows[v].push_back(v);
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      rows[t[k]].push_back(t[(k + 1) % 3]);
      rows[t[k]].push_back(t[(k + 2) % 3]);
    }
  for (std::size_t v = 0; v < count_; ++v) {
    std::sort(rows[v].begin(), rows[v].end());
    rows[v].erase(std::unique(rows[v].begin(), rows[v].end()), rows[v].end());
    vertex_.insert(vertex_.end(), rows[v].begin(), rows[v].end());
    begin_[v + 1] = static_cast<std::uint32_t>(vertex_.size());
  }
  block_.resize(vertex_.size());
  for (const auto& t : triangles) {
    Matrix9 m = bending_of({points[t[0]], points[t[1]], points[t[2]]});
    if (!folded.empty() && (folded[t[0]] != 0 || folded[t[1]] != 0 || folded[t[2]] != 0))
      for (auto& row : m)
        for (double& entry : row) entry /= 1024;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const auto row = rows[t[a]].begin();
        const auto at = static_cast<std::size_t>(std::lower_bound(row, rows[t[a]].end(), t[b]) - row) + begin_[t[a]];
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j) block_[at][i * 3 + j] += m[a * 3 + i][b * 3 + j];
      }
  }
}

void Bending::multiply(const std::vector<double>& x, std::vector<double>& y) const {
  for (std::size_t v = 0; v < count_; ++v) {
    double sx = 0, sy = 0;
    for (std::uint32_t s = begin_[v]; s < begin_[v + 1]; ++s) {
      const double* in = &x[3 * std::size_t{vertex_[s]}];
      const auto& b = block_[s];
      sx += b[3] * in[0] + b[4] * in[1] + b[5] * in[2];
      sy += b[6] * in[0] + b[7] * in[1] + b[8] * in[2];
    }
    y[3 * v] = 0;
    y[3 * v + 1] = sx;
    y[3 * v + 2] = sy;
  }
}

void Bending::relax(std::vector<VertexJet>& data, const std::vector<std::uint8_t>& held) const {
  constexpr double kGoal = 1e-10;  // of the squared, preconditioned residual
  constexpr int kSteps = 200;
  const std::size_t n = 3 * count_;
  std::vector<double> x(n), r(n), y(n, 0.0), p(n), q(n);
  for (std::size_t v = 0; v < count_; ++v)
    for (std::size_t i = 0; i < 3; ++i) x[3 * v + i] = data[v][i];
  // 2 x 2 blocks of the diagonal, inverted.
  std::vector<std::array<double, 3>> inverse(count_, {0, 0, 0});
  for (std::size_t v = 0; v < count_; ++v) {
    if (held[v] != 0) continue;
    std::uint32_t s = begin_[v];
    while (vertex_[s] != v) ++s;
    const double a = block_[s][4], b = block_[s][5], d = block_[s][8], det = a * d - b * b;
    if (det > 1e-12 * a * d) inverse[v] = {d / det, -b / det, a / det};
  }
  const auto precondition = [&] {
    double sum = 0;
    for (std::size_t v = 0; v < count_; ++v) {
      const double rx = r[3 * v + 1], ry = r[3 * v + 2];
      y[3 * v + 1] = inverse[v][0] * rx + inverse[v][1] * ry;
      y[3 * v + 2] = inverse[v][1] * rx + inverse[v][2] * ry;
      sum += rx * y[3 * v + 1] + ry * y[3 * v + 2];
    }
    return sum;
  };
  multiply(x, q);
  for (std::size_t k = 0; k < n; ++k) r[k] = -q[k];
  double now = precondition();
  const double goal = kGoal * now;
  p = y;
  for (int step = 0; step < kSteps && now > goal && now > 1e-280; ++step) {
    multiply(p, q);
    double bend = 0;
    for (std::size_t k = 0; k < n; ++k) bend += p[k] * q[k];
    if (!(bend > 0) || !std::isfinite(bend)) break;
    const double length = now / bend;
    for (std::size_t k = 0; k < n; ++k) {
      x[k] += length * p[k];
      r[k] -= length * q[k];
    }
    const double next = precondition();
    for (std::size_t k = 0; k < n; ++k) p[k] = y[k] + next / now * p[k];
    now = next;
  }
  for (std::size_t v = 0; v < count_; ++v)
    if (held[v] == 0 && std::isfinite(x[3 * v + 1]) && std::isfinite(x[3 * v + 2]))
      data[v] = {data[v][0], x[3 * v + 1], x[3 * v + 2]};
}

}  // namespace retalho
