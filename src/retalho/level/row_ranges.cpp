#include "retalho/level/row_ranges.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "retalho/core/variants.h"

namespace retalho {

namespace {

/// Whole numbers side by side, wherever they stand.
constexpr std::size_t kLanes = 8;
using Lanes = std::int32_t __attribute__((vector_size(4 * kLanes), aligned(4), may_alias));

/// A row's nodes from a column on.
struct NodeRow {
  const std::int32_t *z, *u, *v, *t;
};

/// The range of the ordinates of the patch (of kLanes patches) whose upper nodes are those of `above`, whose lower
/// ones those of `below`.
template <class I>
__attribute__((always_inline)) inline void bound_patches(const NodeRow& above, const NodeRow& below, std::int32_t* low,
                                                         std::int32_t* high) {
  const auto at = [](const std::int32_t* p) { return reinterpret_cast<const I*>(p); };
  I least = *at(above.z), most = least;
  // The four ordinates that a corner has in the patch.
  const auto corner = [&](const NodeRow& row, std::size_t right, bool minus_v) __attribute__((always_inline)) {
    const I h = *at(row.z + right), a = *at(row.u + right), b = *at(row.v + right), m = *at(row.t + right);
    const I p = right != 0 ? h - a : h + a, q = minus_v ? h - b : h + b, r = q + (p - h),
            s = (right != 0) == minus_v ? r + m : r - m;
    for (const I* x : {&h, &p, &q, &s}) {
      least = *x < least ? *x : least;
      most = *x > most ? *x : most;
    }
  };
  corner(above, 0, false);
  corner(above, 1, false);
  corner(below, 0, true);
  corner(below, 1, true);
  *reinterpret_cast<I*>(low) = least;
  *reinterpret_cast<I*>(high) = most;
}

}  // namespace

RETALHO_VARIANTS
void bound_patch_row(const std::int32_t* z, const std::int32_t* u, const std::int32_t* v, const std::int32_t* t,
                     std::size_t width, std::size_t n, std::int32_t* low, std::int32_t* high) {
  const auto row = [&](std::size_t c) { return NodeRow{z + c, u + c, v + c, t + c}; };
  std::size_t c = 0;
  for (; c + kLanes <= n; c += kLanes) bound_patches<Lanes>(row(c), row(c + width), low + c, high + c);
  for (; c < n; ++c) bound_patches<std::int32_t>(row(c), row(c + width), low + c, high + c);
}

namespace {

// Levels of one step: both ends of the range lie in one interval between levels, or they do not. Places are shifted to
// be positive, so that cutting off the fraction is rounding down.
RETALHO_VARIANTS
void mark_even(const std::int32_t* low, const std::int32_t* high, std::size_t n, double first, double per_step,
               double shift, std::uint8_t* marked) {
  for (std::size_t c = 0; c < n; ++c) {
    const auto below = static_cast<std::int32_t>((2.0 * low[c] - 6 - first) * per_step + shift - 1e-6);
    const auto above = static_cast<std::int32_t>((2.0 * high[c] + 6 - first) * per_step + shift + 1e-6);
    marked[c] = below != above ? 1 : 0;
  }
}

}  // namespace

std::size_t select_ranges(const std::int32_t* low, const std::int32_t* high, std::size_t n, const FixedLevels& levels,
                          std::uint8_t* marked, std::uint32_t* places) {
  // Doubled heights are below 2^25; their place counts levels, and a double holds it to 1e-7 up to 2^28.
  constexpr double kReach = 0x1p26;
  const double shift = std::floor(kReach * levels.per_step()) + 2;
  if (!levels.even() || !(shift < 0x1p28)) {
    for (std::size_t c = 0; c < n; ++c) marked[c] = levels.may_cross(2.0 * low[c], 2.0 * high[c]) ? 1 : 0;
  } else {
    mark_even(low, high, n, levels.first(), levels.per_step(), shift, marked);
  }
  std::size_t found = 0, c = 0;
  const auto look = [&](std::size_t to) {
    for (; c < to; ++c) {
      places[found] = static_cast<std::uint32_t>(c);
      found += marked[c];
    }
  };
  while (c < n) {
    std::uint64_t eight = 0;
    if (c + sizeof eight <= n) std::memcpy(&eight, marked + c, sizeof eight);
    if (c + sizeof eight <= n && eight == 0)
      c += sizeof eight;
    else
      look(std::min(c + sizeof eight, n));
  }
  return found;
}

}  // namespace retalho
