#include "retalho/level/implicit_tensor.h"

#include <algorithm>
#include <cmath>

#include "retalho/bernstein/segment.h"

namespace retalho {

namespace {

constexpr int kMaxDegree = 30;
constexpr double kUnit = 0x1p-53;

double largest(const TensorBernstein& p) {
  double m = 0;
  for (const double v : p.c) m = std::max(m, std::abs(v));
  return m;
}

TensorBernstein constant(double v) {
  return {0, 0, {v}, 0};
}

/// One degree more in x (or y); every new coefficient is a mean of two, so the error grows by two roundings of it.
TensorBernstein elevate(const TensorBernstein& p, bool in_x) {
  TensorBernstein q{p.degree_x + (in_x ? 1 : 0), p.degree_y + (in_x ? 0 : 1), {}, 0};
  q.c.resize(static_cast<std::size_t>((q.degree_x + 1) * (q.degree_y + 1)));
  for (int i = 0; i <= q.degree_x; ++i)
    for (int j = 0; j <= q.degree_y; ++j) {
      const int k = in_x ? i : j, n = in_x ? q.degree_x : q.degree_y;
      const double s = static_cast<double>(k) / n;
      const double before = k > 0 ? (in_x ? p.at(i - 1, j) : p.at(i, j - 1)) : 0;
      const double here = k < n ? p.at(i, j) : 0;
      q.c[static_cast<std::size_t>(i * (q.degree_y + 1) + j)] = s * before + (1 - s) * here;
    }
  q.error = p.error + 4 * kUnit * largest(p);
  return q;
}

TensorBernstein elevate_to(TensorBernstein p, int dx, int dy) {
  while (p.degree_x < dx) p = elevate(p, true);
  while (p.degree_y < dy) p = elevate(p, false);
  return p;
}

TensorBernstein add(const TensorBernstein& a, const TensorBernstein& b, double s) {
  const int dx = std::max(a.degree_x, b.degree_x), dy = std::max(a.degree_y, b.degree_y);
  TensorBernstein p = elevate_to(a, dx, dy);
  const TensorBernstein q = elevate_to(b, dx, dy);
  for (std::size_t i = 0; i < p.c.size(); ++i) p.c[i] += s * q.c[i];
  p.error += q.error + kUnit * largest(p);
  return p;
}

std::optional<TensorBernstein> multiply(const TensorBernstein& a, const TensorBernstein& b) {
  TensorBernstein p{a.degree_x + b.degree_x, a.degree_y + b.degree_y, {}, 0};
  if (p.degree_x > kMaxDegree || p.degree_y > kMaxDegree) return std::nullopt;
  p.c.assign(static_cast<std::size_t>((p.degree_x + 1) * (p.degree_y + 1)), 0.0);
  for (int i = 0; i <= a.degree_x; ++i)
    for (int k = 0; k <= b.degree_x; ++k) {
      const double fx = binomial(a.degree_x, i) * binomial(b.degree_x, k) / binomial(p.degree_x, i + k);
      for (int j = 0; j <= a.degree_y; ++j)
        for (int l = 0; l <= b.degree_y; ++l) {
          const double fy = binomial(a.degree_y, j) * binomial(b.degree_y, l) / binomial(p.degree_y, j + l);
          p.c[static_cast<std::size_t>((i + k) * (p.degree_y + 1) + j + l)] += fx * fy * a.at(i, j) * b.at(k, l);
        }
    }
  // Each coefficient is a mean (weights fx fy sum to 1) of at most terms products; each product has 8 roundings.
  const int terms = (std::min(a.degree_x, b.degree_x) + 1) * (std::min(a.degree_y, b.degree_y) + 1);
  const double ma = largest(a), mb = largest(b);
  p.error = a.error * mb + b.error * ma + a.error * b.error + (terms + 8) * 2 * kUnit * ma * mb;
  return p;
}

}  // namespace

std::optional<TensorBernstein> polynomial_on_box(const Expression& f, const PlaneBox& box) {
  using Op = Expression::Op;
  std::vector<std::optional<TensorBernstein>> v(f.nodes().size());
  std::vector<char> fixed(f.nodes().size(), 0);  // no x or y below
  std::vector<double> number(f.nodes().size(), 0);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto& n = f.nodes()[i];
    const auto a = static_cast<std::size_t>(std::max(n.a, 0)), b = static_cast<std::size_t>(std::max(n.b, 0));
    fixed[i] = n.op != Op::x && n.op != Op::y && (n.a < 0 || fixed[a]) && (n.b < 0 || fixed[b]);
    if (fixed[i]) {
      number[i] = Expression::apply(n, number[a], number[b]);
      if (!std::isfinite(number[i])) return std::nullopt;
      v[i] = constant(number[i]);
      if (n.op != Op::number) v[i]->error = 8 * kUnit * std::abs(number[i]);
      continue;
    }
    switch (n.op) {
      case Op::x:
        v[i] = TensorBernstein{1, 0, {box.x0, box.x1}, 0};
        break;
      case Op::y:
        v[i] = TensorBernstein{0, 1, {box.y0, box.y1}, 0};
        break;
      case Op::add:
        if (v[a] && v[b]) v[i] = add(*v[a], *v[b], 1);
        break;
      case Op::subtract:
        if (v[a] && v[b]) v[i] = add(*v[a], *v[b], -1);
        break;
      case Op::negate:
        if (v[a]) v[i] = add(constant(0), *v[a], -1);
        break;
      case Op::multiply:
        if (v[a] && v[b]) v[i] = multiply(*v[a], *v[b]);
        break;
      case Op::divide:
        if (v[a] && fixed[b] && number[b] != 0) {
          v[i] = v[a];
          for (double& c : v[i]->c) c /= number[b];
          v[i]->error = v[i]->error / std::abs(number[b]) + 10 * kUnit * largest(*v[i]);
        }
        break;
      case Op::power:
        if (v[a] && fixed[b] && number[b] == std::floor(number[b]) && number[b] >= 0 && number[b] <= kMaxDegree) {
          v[i] = constant(1);
          for (int k = 0; k < static_cast<int>(number[b]) && v[i]; ++k) v[i] = multiply(*v[i], *v[a]);
        }
        break;
      default:
        break;
    }
  }
  auto result = v.back();
  if (result) result = elevate_to(*result, std::max(1, result->degree_x), std::max(1, result->degree_y));
  if (result && !std::isfinite(largest(*result))) return std::nullopt;
  return result;
}

double evaluate(const TensorBernstein& p, double u, double v) {
  Bernstein column(static_cast<std::size_t>(p.degree_x) + 1);
  const std::size_t rows = static_cast<std::size_t>(p.degree_y) + 1;
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = evaluate(std::span(p.c).subspan(i * rows, rows), v);
  return evaluate(column, u);
}

}  // namespace retalho
