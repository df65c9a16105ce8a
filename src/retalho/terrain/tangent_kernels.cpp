#include "retalho/terrain/tangent_kernels.h"

#include <cmath>

#include "retalho/core/variants.h"

namespace retalho {
namespace {

// m(k-1) + 4 m(k) + m(k+1) = 3 (z(k+1) - z(k-1)) on an endless row has the solution
// m(i) = c sum_k p^(k-1) (z(i+k) - z(i-k)), p = sqrt(3) - 2.
const double kDecay = std::sqrt(3.0) - 2;
const double kWeight = std::sqrt(3.0) / 2 * (1 - kDecay * kDecay);

using Pivots = std::array<double, static_cast<std::size_t>(2 * kSplineHalo) + 1>;

Pivots make_pivots(double first) {
  Pivots upper{first};
  for (std::size_t k = 1; k < upper.size(); ++k) upper[k] = 1 / (4 - upper[k - 1]);
  return upper;
}

constexpr std::size_t kHalo = static_cast<std::size_t>(kSplineHalo), kRun = static_cast<std::size_t>(kLongRun);

/// Doubles side by side, wherever they stand.
constexpr std::size_t kLanes = 4;
using Lanes = double __attribute__((vector_size(8 * kLanes), aligned(8), may_alias));
static_assert(sizeof(Lanes) == sizeof(EndSamples::value_type));

}  // namespace

const Pivots& pivots(TangentEnds ends) {
  static const Pivots not_a_knot = make_pivots(2), natural = make_pivots(0.5);
  return ends == TangentEnds::not_a_knot ? not_a_knot : natural;
}

const Pivots& cut_pivots() {
  static const Pivots cut = make_pivots(0);
  return cut;
}

RETALHO_VARIANTS
void inner_tangents(const double* centre, std::ptrdiff_t stride, std::size_t n, double* out) {
  const double decay = kDecay, weight = kWeight;
  std::size_t x = 0;
  constexpr std::size_t kSums = 8;  // at once: each waits for itself only
  for (; x + kSums * kLanes <= n; x += kSums * kLanes) {
    Lanes sum[kSums] = {};
    for (int k = kSplineHalo; k >= 1; --k) {
      const auto* after = reinterpret_cast<const Lanes*>(centre + x + k * stride);
      const auto* before = reinterpret_cast<const Lanes*>(centre + x - k * stride);
      for (std::size_t i = 0; i < kSums; ++i) sum[i] = sum[i] * decay + (after[i] - before[i]);
    }
    auto* to = reinterpret_cast<Lanes*>(out + x);
    for (std::size_t i = 0; i < kSums; ++i) to[i] = sum[i] * weight;
  }
  for (; x < n; ++x) {
    double sum = 0;
    for (int k = kSplineHalo; k >= 1; --k) sum = sum * decay + (centre[x + k * stride] - centre[x - k * stride]);
    out[x] = sum * weight;
  }
}

RETALHO_VARIANTS
void first_tangents(const EndSamples& samples, TangentEnds ends, EndTangents& out) {
  const auto* z = reinterpret_cast<const Lanes*>(samples.data());
  auto* tangent = reinterpret_cast<Lanes*>(out.data());
  const Pivots& upper = pivots(ends);
  // One elimination serves all: the places differ in where the line is cut behind them.
  Lanes rest[kRun];
  rest[0] = ends == TangentEnds::not_a_knot ? (-5 * z[0] + 4 * z[1] + z[2]) / 2 : 1.5 * (z[1] - z[0]);
  for (std::size_t k = 1; k + 1 < kRun; ++k) rest[k] = (3 * (z[k + 1] - z[k - 1]) - rest[k - 1]) * upper[k];
  for (std::size_t at = 0; at < kHalo; ++at) {
    Lanes m{};
    for (std::size_t k = at + kHalo; k-- > at;) m = rest[k] - upper[k] * m;
    tangent[at] = m;
  }
}

RETALHO_VARIANTS
void last_tangents(const EndSamples& samples, TangentEnds ends, EndTangents& out) {
  const auto* z = reinterpret_cast<const Lanes*>(samples.data());
  auto* tangent = reinterpret_cast<Lanes*>(out.data());
  const Pivots& upper = cut_pivots();
  for (std::size_t place = 0; place < kHalo; ++place) {
    const Lanes* cut = z + place;
    const std::size_t size = kRun - place;  // samples from the cut to the line's end
    Lanes rest[kRun];
    rest[0] = Lanes{};
    for (std::size_t k = 1; k + 1 < size; ++k) rest[k] = (3 * (cut[k + 1] - cut[k - 1]) - rest[k - 1]) * upper[k];
    const Lanes before = rest[size - 2];
    const double slope = upper[size - 2];
    const Lanes *last = cut + size - 1, *second = last - 1, *third = last - 2;
    Lanes m;
    if (ends == TangentEnds::not_a_knot)
      m = ((5 * *last - 4 * *second - *third) / 2 - 2 * before) / (1 - 2 * slope);
    else
      m = (3 * (*last - *second) - before) / (2 - slope);
    for (std::size_t k = size - 1; k-- > kHalo;) m = rest[k] - upper[k] * m;
    tangent[place] = m;
  }
}

}  // namespace retalho
