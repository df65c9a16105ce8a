#include "retalho/patch/weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace retalho {
namespace {

/// A weight is at least this share of the largest: zero angles must not make one vanish, or the map may fold.
constexpr double kLeast = 1e-7;

void normalize(std::vector<double>& weights) {
  double largest = 0, sum = 0;
  for (const double w : weights) largest = std::max(largest, w);
  for (double& w : weights) {
    w = largest > 0 ? std::max(w / largest, kLeast) : 1;
    sum += w;
  }
  for (double& w : weights) w /= sum;
}

}  // namespace

void NeighborWeights::compute(Vec3 centre, std::span<const Vec3> neighbors, Weights kind, std::vector<double>& out) {
  const std::size_t d = neighbors.size();
  length_.resize(d);
  angle_.resize(d);
  out.assign(d, 0.0);
  for (std::size_t k = 0; k < d; ++k) length_[k] = norm(neighbors[k] - centre);
  if (kind == Weights::mean_value) {
    // tan of half the angle = |a x b| / (|a| |b| + a . b): no inverse function, and exact for small angles.
    for (std::size_t k = 0; k < d; ++k) {
      const std::size_t next = k + 1 == d ? 0 : k + 1;
      const Vec3 a = neighbors[k] - centre, b = neighbors[next] - centre;
      const double below = length_[k] * length_[next] + dot(a, b);
      const double tangent = norm(cross(a, b)) / std::max(below, 1e-12 * length_[k] * length_[next]);
      angle_[k] = tangent;
    }
    mean_value(out);
  } else {
    for (std::size_t k = 0; k < d; ++k) {
      const Vec3 a = neighbors[k] - centre, b = neighbors[k + 1 == d ? 0 : k + 1] - centre;
      angle_[k] = std::atan2(norm(cross(a, b)), dot(a, b));
    }
    shape_preserving(out);
  }
  normalize(out);
}

void NeighborWeights::mean_value(std::vector<double>& out) const {
  const std::size_t d = out.size();
  for (std::size_t k = 0; k < d; ++k) out[k] = (angle_[k == 0 ? d - 1 : k - 1] + angle_[k]) / length_[k];
}

void NeighborWeights::shape_preserving(std::vector<double>& out) {
  const std::size_t d = out.size();
  double sum = 0;
  for (const double a : angle_) sum += a;
  theta_.resize(d + 1);
  flat_.resize(d);
  double theta = 0;
  for (std::size_t k = 0; k < d; ++k) {
    theta_[k] = theta;
    flat_[k] = {length_[k] * std::cos(theta), length_[k] * std::sin(theta)};
    theta += 2 * std::numbers::pi * (sum > 0 ? angle_[k] / sum : 1.0 / static_cast<double>(d));
  }
  theta_[d] = 2 * std::numbers::pi;
  // The line from p_k through the origin leaves between p_r and p_r+1; r runs round once as k does.
  std::size_t r = 0;
  int turns = 0;
  const auto angle_at = [&](std::size_t i, int turn) { return theta_[i] + 2 * std::numbers::pi * turn; };
  for (std::size_t k = 0; k < d; ++k) {
    const double out_angle = theta_[k] + std::numbers::pi;
    while (angle_at(r + 1, turns) < out_angle)
      if (++r == d) {
        r = 0;
        ++turns;
      }
    const std::size_t next = r + 1 == d ? 0 : r + 1;
    const double a = std::max(0.0, cross(flat_[r], flat_[next])), b = std::max(0.0, cross(flat_[next], flat_[k])),
                 c = std::max(0.0, cross(flat_[k], flat_[r])), all = a + b + c;
    if (!(all > 0)) {  // the three are on one line with the origin
      out[k] += 0.5;
      out[r] += 0.5;
      continue;
    }
    out[k] += a / all;
    out[r] += b / all;
    out[next] += c / all;
  }
}

}  // namespace retalho
