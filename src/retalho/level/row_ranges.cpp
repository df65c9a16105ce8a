#include "retalho/level/row_ranges.h"

#include <algorithm>

#include "retalho/core/variants.h"

namespace retalho {

RETALHO_VARIANTS
void bound_edge_row(const std::int32_t* z, const std::int32_t* d, std::size_t step, std::size_t n, std::int32_t* low,
                    std::int32_t* high) {
  for (std::size_t c = 0; c < n; ++c) {
    const std::int32_t a = z[c], b = z[c] + d[c], e = z[c + step] - d[c + step], f = z[c + step];
    low[c] = std::min(std::min(a, b), std::min(e, f));
    high[c] = std::max(std::max(a, b), std::max(e, f));
  }
}

RETALHO_VARIANTS
void bound_patch_row(const std::int32_t* z, const std::int32_t* u, const std::int32_t* v, const std::int32_t* t,
                     std::size_t width, std::size_t n, std::int32_t* low, std::int32_t* high) {
  for (std::size_t c = 0; c < n; ++c) {
    std::int32_t least = z[c], most = z[c];
    // The four ordinates that a corner has in the patch.
    const auto corner = [&](std::int32_t h, std::int32_t a, std::int32_t b, std::int32_t m) {
      const std::int32_t p = h + a, q = h + b, r = p + b + m;
      least = std::min(least, std::min(std::min(h, p), std::min(q, r)));
      most = std::max(most, std::max(std::max(h, p), std::max(q, r)));
    };
    const std::size_t e = c + 1, s = c + width, d = s + 1;
    corner(z[c], u[c], v[c], t[c]);
    corner(z[e], -u[e], v[e], -t[e]);
    corner(z[s], u[s], -v[s], -t[s]);
    corner(z[d], -u[d], -v[d], t[d]);
    low[c] = least;
    high[c] = most;
  }
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

void mark_ranges(const std::int32_t* low, const std::int32_t* high, std::size_t n, const FixedLevels& levels,
                 std::uint8_t* marked) {
  // Doubled heights are below 2^25; their place counts levels, and a double holds it to 1e-7 up to 2^28.
  constexpr double kReach = 0x1p26;
  const double shift = std::floor(kReach * levels.per_step()) + 2;
  if (!levels.even() || !(shift < 0x1p28)) {
    for (std::size_t c = 0; c < n; ++c) marked[c] = levels.may_cross(2.0 * low[c], 2.0 * high[c]) ? 1 : 0;
    return;
  }
  mark_even(low, high, n, levels.first(), levels.per_step(), shift, marked);
}

}  // namespace retalho
