#include "retalho/terrain/side.h"

#include <array>
#include <cstddef>

namespace retalho {
namespace {

/// A sum of doubles that do not overlap, smallest first: its sign is the sign of the last.
struct Expansion {
  std::array<double, 12> part{};
  std::size_t size = 0;

  void add(double b) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const double sum = b + part[k];
      const double virtual_part = sum - b;
      const double rest = (b - (sum - virtual_part)) + (part[k] - virtual_part);
      b = sum;
      if (rest != 0) part[kept++] = rest;
    }
    if (b != 0) part[kept++] = b;
    size = kept;
  }
  void add_product(double x, double y) {
    const double product = x * y;
    add(std::fma(x, y, -product));
    add(product);
  }
};

/// Whole numbers below 2^25: cell coordinates, whose determinant is exact in double.
bool small_whole(double v) {
  return std::abs(v) < 0x1p25 && static_cast<double>(static_cast<int>(v)) == v;
}
bool small_whole(Vec2 v) {
  return small_whole(v.x) && small_whole(v.y);
}

}  // namespace

int exact_side_of(Vec2 a, Vec2 b, Vec2 c) {
  if (small_whole(a) && small_whole(b) && small_whole(c)) {
    const double det = cross(a - c, b - c);
    return det > 0 ? 1 : det < 0 ? -1 : 0;
  }
  Expansion sum;
  sum.add_product(a.x, b.y);
  sum.add_product(-a.x, c.y);
  sum.add_product(-c.x, b.y);
  sum.add_product(-a.y, b.x);
  sum.add_product(a.y, c.x);
  sum.add_product(c.y, b.x);
  if (sum.size == 0) return 0;
  return sum.part[sum.size - 1] > 0 ? 1 : -1;
}

}  // namespace retalho
