#include "retalho/patch/locator.h"

#include <algorithm>
#include <cmath>

namespace retalho {
namespace {

std::uint32_t cell_of(double x, std::uint32_t cells) {
  const double at = x * cells;
  return at <= 0 ? 0 : std::min(static_cast<std::uint32_t>(at), cells - 1);
}

}  // namespace

Vec2 clamp_to_domain(Vec2 p) {
  if (p.x + p.y > 1) {
    const double over = (p.x + p.y - 1) / 2;
    p = {p.x - over, p.y - over};
    if (p.x < 0) return {0, 1};
    if (p.y < 0) return {1, 0};
    return p;
  }
  p = {std::clamp(p.x, 0.0, 1.0), std::clamp(p.y, 0.0, 1.0)};
  return p;
}

DomainLocator::DomainLocator(const Domain& domain) {
  const std::size_t count = domain.triangles.size();
  cells_ = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count))));
  frames_.resize(count);
  first_.assign(std::size_t{cells_} * cells_ + 1, 0);
  struct Entry {
    std::uint32_t cell, triangle;
  };
  std::vector<Entry> entries;
  entries.reserve(4 * count);
  const double width = 1.0 / cells_, half = width / 2 * (1 + 1e-9);
  for (std::uint32_t t = 0; t < count; ++t) {
    const Vec2 a = domain.parameters[domain.triangles[t][0]], b = domain.parameters[domain.triangles[t][1]],
               c = domain.parameters[domain.triangles[t][2]];
    const Vec2 ab = b - a, ac = c - a;
    const double area = cross(ab, ac);
    Frame& f = frames_[t];
    f = {a, Vec2{ac.y, -ac.x} / area, Vec2{-ab.y, ab.x} / area};
    const Vec2 g1 = -(f.g2 + f.g3);
    const double e1 = half * (std::abs(g1.x) + std::abs(g1.y)), e2 = half * (std::abs(f.g2.x) + std::abs(f.g2.y)),
                 e3 = half * (std::abs(f.g3.x) + std::abs(f.g3.y));
    const std::uint32_t x0 = cell_of(std::min({a.x, b.x, c.x}), cells_),
                        x1 = cell_of(std::max({a.x, b.x, c.x}), cells_),
                        y0 = cell_of(std::min({a.y, b.y, c.y}), cells_),
                        y1 = cell_of(std::max({a.y, b.y, c.y}), cells_);
    for (std::uint32_t y = y0; y <= y1; ++y)
      for (std::uint32_t x = x0; x <= x1; ++x) {
        const Vec2 d = Vec2{(x + 0.5) * width, (y + 0.5) * width} - a;
        const double l2 = dot(f.g2, d), l3 = dot(f.g3, d);
        // The largest value of each coordinate in the cell, with room for rounding in thin triangles.
        if (1 - l2 - l3 + e1 < -1e-9 || l2 + e2 < -1e-9 || l3 + e3 < -1e-9) continue;
        entries.push_back({y * cells_ + x, t});
        ++first_[entries.back().cell + 1];
      }
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  triangles_.resize(entries.size());
  for (const Entry& e : entries) triangles_[first_[e.cell]++] = e.triangle;
  for (std::size_t i = first_.size(); i-- > 1;) first_[i] = first_[i - 1];  // each start had moved to the next one's
  first_[0] = 0;
}

DomainPlace DomainLocator::locate(Vec2 p) const {
  DomainPlace place;
  if (!(p.x >= 0 && p.y >= 0 && p.x + p.y <= 1)) {
    place.inside = false;
    p = clamp_to_domain(p);
  }
  const std::size_t cell = std::size_t{cell_of(p.y, cells_)} * cells_ + cell_of(p.x, cells_);
  double best = -1e300;
  for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
    const std::uint32_t t = triangles_[i];
    const Frame& f = frames_[t];
    const Vec2 d = p - f.a;
    const double l2 = dot(f.g2, d), l3 = dot(f.g3, d), l1 = 1 - l2 - l3;
    // Selected, not branched on: which candidate it is cannot be predicted, and the next point need not wait for it.
    const double least = std::min(l1, std::min(l2, l3));
    const bool better = least > best;
    best = better ? least : best;
    place.triangle = better ? t : place.triangle;
    place.l1 = better ? l1 : place.l1;
    place.l2 = better ? l2 : place.l2;
    place.l3 = better ? l3 : place.l3;
  }
  return place;
}

}  // namespace retalho
