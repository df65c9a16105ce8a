#include "retalho/level/implicit_field.h"

#include <algorithm>
#include <cmath>

namespace retalho {

namespace {

constexpr double kUnit = 0x1p-53;

double largest(std::span<const double> c) {
  double m = 0;
  for (const double v : c) m = std::max(m, std::abs(v));
  return m;
}

/// What rounding may have left of a zero at a corner.
double corner_zero(const Bernstein& edge) {
  return 16 * static_cast<double>(edge.size()) * kUnit * largest(edge);
}

}  // namespace

std::array<PolynomialField::Cell, 4> PolynomialField::split(const Cell& cell, const PlaneBox&) const {
  const auto rows = static_cast<std::size_t>(nx_) + 1, columns = static_cast<std::size_t>(ny_) + 1;
  std::array<Cell, 4> child;
  // Halving is a mean of neighbours, degree times over: each mean is rounded once.
  const double error = cell.error + (nx_ + ny_) * kUnit * largest(cell.c);
  for (Cell& c : child) {
    c.c.resize(cell.c.size());
    c.error = error;
  }
  std::vector<double> west(cell.c.size()), east(cell.c), line(rows), left(rows), right(rows);
  for (std::size_t j = 0; j < columns; ++j) {
    for (std::size_t i = 0; i < rows; ++i) line[i] = cell.c[i * columns + j];
    subdivide(line, 0.5, left, right);
    for (std::size_t i = 0; i < rows; ++i) west[i * columns + j] = left[i], east[i * columns + j] = right[i];
  }
  for (std::size_t i = 0; i < rows; ++i) {
    const auto row = [&](std::vector<double>& c) { return std::span(c).subspan(i * columns, columns); };
    subdivide(row(west), 0.5, row(child[0].c), row(child[2].c));
    subdivide(row(east), 0.5, row(child[1].c), row(child[3].c));
  }
  return child;
}

bool PolynomialField::absent(const Cell& cell) const {
  const auto [low, high] = bounds(cell.c);
  return low > cell.error || high < -cell.error;
}

std::pair<int, int> PolynomialField::gradient_signs(const Cell& cell) const {
  const auto rows = static_cast<std::size_t>(nx_) + 1, columns = static_cast<std::size_t>(ny_) + 1;
  double x_low = 1e300, x_high = -1e300, y_low = 1e300, y_high = -1e300;
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; ++j) {
      const double v = cell.c[i * columns + j];
      if (i + 1 < rows) {
        const double d = cell.c[(i + 1) * columns + j] - v;
        x_low = std::min(x_low, d), x_high = std::max(x_high, d);
      }
      if (j + 1 < columns) {
        const double d = cell.c[i * columns + j + 1] - v;
        y_low = std::min(y_low, d), y_high = std::max(y_high, d);
      }
    }
  const double slack = 2 * cell.error + 2 * kUnit * largest(cell.c);
  const auto sign = [slack](double low, double high) { return low > slack ? 1 : high < -slack ? -1 : 0; };
  return {sign(x_low, x_high), sign(y_low, y_high)};
}

PolynomialField::Edge PolynomialField::edge(const Cell& cell, int side, double, double, double) const {
  const auto rows = static_cast<std::size_t>(nx_) + 1, columns = static_cast<std::size_t>(ny_) + 1;
  Edge e(side == 0 || side == 2 ? rows : columns);
  for (std::size_t k = 0; k < e.size(); ++k)
    e[k] = side == 0   ? cell.c[k * columns]
           : side == 2 ? cell.c[k * columns + columns - 1]
           : side == 3 ? cell.c[k]
                       : cell.c[(rows - 1) * columns + k];
  return e;
}

EdgeRoots PolynomialField::roots(const Edge& edge) const {
  EdgeRoots result;
  const double zero = corner_zero(edge);
  const auto [low, high] = bounds(edge);
  if (low > zero || high < -zero) return result;
  result.at_start = std::abs(edge.front()) <= zero;
  result.at_end = std::abs(edge.back()) <= zero;
  if (largest(edge) == 0) {
    result.zero = true;
    return result;
  }
  for (const BernsteinRoot& r : retalho::roots(edge))
    if (r.t > 0 && r.t < 1) result.inner.push_back(r.t);
  return result;
}

bool PolynomialField::cut(const Edge& edge, Edge& first, Edge& second) const {
  first.resize(edge.size());
  second.resize(edge.size());
  subdivide(edge, 0.5, first, second);
  return std::abs(second.front()) <= corner_zero(edge);
}

double PolynomialField::height(const Cell& cell, const PlaneBox& box, bool over_x, double along) const {
  const auto rows = static_cast<std::size_t>(nx_) + 1, columns = static_cast<std::size_t>(ny_) + 1;
  const double t = over_x ? (along - box.x0) / (box.x1 - box.x0) : (along - box.y0) / (box.y1 - box.y0);
  Bernstein line(over_x ? columns : rows), across(over_x ? rows : columns);
  for (std::size_t k = 0; k < line.size(); ++k) {
    for (std::size_t i = 0; i < across.size(); ++i)
      across[i] = over_x ? cell.c[i * columns + k] : cell.c[k * columns + i];
    line[k] = evaluate(across, t);
  }
  const auto found = retalho::roots(line);
  const double at = !found.empty() ? found.front().t : std::abs(line.front()) < std::abs(line.back()) ? 0 : 1;
  return over_x ? box.y0 + at * (box.y1 - box.y0) : box.x0 + at * (box.x1 - box.x0);
}

double IntervalField::height(const Cell&, const PlaneBox& box, bool over_x, double along) const {
  Edge e = over_x ? Edge{box.y0, box.y1, along, true} : Edge{box.x0, box.x1, along, false};
  const double low = at(e, e.from), high = at(e, e.to);
  if (!(low * high < 0)) return std::abs(low) < std::abs(high) ? e.from : e.to;
  std::vector<double> found;
  search(e, e.from, e.to, 0, found);
  return found.empty() ? 0.5 * (e.from + e.to) : found.front();
}

std::array<IntervalField::Cell, 4> IntervalField::split(const Cell&, const PlaneBox& b) const {
  const double xm = b.x0 + 0.5 * (b.x1 - b.x0), ym = b.y0 + 0.5 * (b.y1 - b.y0);
  // The middle is rounded: each child reaches a little over it, so that no gap is left between them.
  const double xl = std::nextafter(xm, b.x0), xh = std::nextafter(xm, b.x1), yl = std::nextafter(ym, b.y0),
               yh = std::nextafter(ym, b.y1);
  return {cell({b.x0, b.y0, xh, yh}), cell({xl, b.y0, b.x1, yh}), cell({b.x0, yl, xh, b.y1}),
          cell({xl, yl, b.x1, b.y1})};
}

std::pair<int, int> IntervalField::gradient_signs(const Cell& cell) const {
  if (!cell.jet.defined || !cell.jet.smooth) return {0, 0};
  const auto sign = [](Interval i) { return i.low > 0 ? 1 : i.high < 0 ? -1 : 0; };
  return {sign(cell.jet.dx), sign(cell.jet.dy)};
}

IntervalField::Edge IntervalField::edge(const Cell&, int side, double from, double to, double fixed) const {
  return {from, to, fixed, side == 1 || side == 3};
}

void IntervalField::search(const Edge& e, double a, double b, int level, std::vector<double>& out) const {
  const IntervalJet jet = e.vertical ? f_.enclose({e.fixed, e.fixed}, {a, b}) : f_.enclose({a, b}, {e.fixed, e.fixed});
  if (!jet.possible || !jet.value.contains_zero()) return;
  const Interval slope = e.vertical ? jet.dy : jet.dx;
  const bool monotone = jet.defined && jet.smooth && !slope.contains_zero();
  if (!monotone && level < (jet.defined ? 14 : 6)) {
    const double middle = 0.5 * (a + b);
    if (at(e, middle) == 0) out.push_back(middle);
    search(e, a, middle, level + 1, out);
    search(e, middle, b, level + 1, out);
    return;
  }
  double low = at(e, a), high = at(e, b);
  if (!jet.defined || !(low * high < 0)) return;
  double p = a, q = b;
  for (int step = 0; step < 100 && std::nextafter(p, q) < q; ++step) {
    // False position and halving in turn: fast near a simple root, never worse than halving twice over.
    double m = step % 2 == 0 ? p - low * (q - p) / (high - low) : 0.5 * (p + q);
    if (!(m > p && m < q)) m = 0.5 * (p + q);
    const double v = at(e, m);
    if (v == 0) {
      p = q = m;
      break;
    }
    if ((v < 0) == (low < 0))
      p = m, low = v;
    else
      q = m, high = v;
  }
  out.push_back(0.5 * (p + q));
}

EdgeRoots IntervalField::roots(const Edge& e) const {
  EdgeRoots result;
  result.at_start = at(e, e.from) == 0;
  result.at_end = at(e, e.to) == 0;
  std::vector<double> found;
  search(e, e.from, e.to, 0, found);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  for (const double v : found) result.inner.push_back((v - e.from) / (e.to - e.from));
  return result;
}

bool IntervalField::cut(const Edge& e, Edge& first, Edge& second) const {
  first = second = e;
  first.to = second.from = e.from + 0.5 * (e.to - e.from);
  return at(e, first.to) == 0;
}

}  // namespace retalho
