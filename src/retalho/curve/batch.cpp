#include "retalho/curve/batch.h"

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/core/variants.h"
#include "retalho/curve/convert.h"
#include "retalho/curve/edit.h"

namespace retalho {

namespace {

RETALHO_VARIANTS void cubic_coordinate(double b0, double b1, double b2, double b3, const double* t, double* out,
                                       std::size_t n) {
  const double c1 = 3 * b1, c2 = 3 * b2;
  for (std::size_t i = 0; i < n; ++i) {
    const double v = t[i], s = 1 - v;
    // ((s b0 + v 3 b1) s + v^2 3 b2) s + v^3 b3
    const double v2 = v * v;
    out[i] = ((b0 * s + c1 * v) * s + c2 * v2) * s + b3 * (v2 * v);
  }
}

}  // namespace

void evaluate_cubic(const std::array<Vec3, 4>& p, std::span<const double> t, std::span<double> x, std::span<double> y,
                    std::span<double> z) {
  if (x.size() != t.size() || y.size() != t.size() || z.size() != t.size())
    throw UsageError("evaluate_cubic: all arrays must have one length");
  // In blocks, so that the parameters are still in the nearest cache for the second and third coordinate.
  constexpr std::size_t kBlock = 1024;
  for (std::size_t at = 0; at < t.size(); at += kBlock) {
    const std::size_t n = std::min(kBlock, t.size() - at);
    cubic_coordinate(p[0].x, p[1].x, p[2].x, p[3].x, t.data() + at, x.data() + at, n);
    cubic_coordinate(p[0].y, p[1].y, p[2].y, p[3].y, t.data() + at, y.data() + at, n);
    cubic_coordinate(p[0].z, p[1].z, p[2].z, p[3].z, t.data() + at, z.data() + at, n);
  }
}

CubicEvaluator::CubicEvaluator(const Curve& curve) {
  if (curve.empty() || curve.rational() || curve.degree() > 3)
    throw UsageError("CubicEvaluator: a polynomial curve of degree 3 or less is needed");
  const Curve cubic = elevate(curve, 3);
  for (std::size_t i = 0; i < cubic.segment_count(); ++i) {
    const CurveSegment s = cubic.segment(i);
    const std::vector<Vec3> a = to_power(s);
    Span span{
        {a[0].x, a[1].x, a[2].x, a[3].x, a[0].y, a[1].y, a[2].y, a[3].y, a[0].z, a[1].z, a[2].z, a[3].z}, s.from, s.to};
    spans_.push_back(span);
  }
  begin_ = curve.begin();
  end_ = curve.end();
  const std::size_t buckets = 4 * spans_.size();
  scale_ = static_cast<double>(buckets) / (end_ - begin_);
  bucket_.resize(buckets + 1);
  std::uint32_t k = 0;
  for (std::size_t b = 0; b <= buckets; ++b) {
    // A little early, so that rounding of the division never starts behind the right span.
    const double u = begin_ + (static_cast<double>(b) - 1e-6) / scale_;
    while (k + 1 < spans_.size() && spans_[k].to <= u) ++k;
    bucket_[b] = k;
  }
}

void CubicEvaluator::operator()(std::span<const double> u, std::span<double> x, std::span<double> y,
                                std::span<double> z) const {
  if (x.size() != u.size() || y.size() != u.size() || z.size() != u.size())
    throw UsageError("CubicEvaluator: all arrays must have one length");
  const auto last = static_cast<std::uint32_t>(spans_.size() - 1);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double v = std::min(std::max(u[i], begin_), end_);
    std::uint32_t k = bucket_[static_cast<std::size_t>((v - begin_) * scale_)];
    while (k < last && v >= spans_[k].to) ++k;
    const Span& s = spans_[k];
    const double t = v - s.from;
    x[i] = s.c[0] + t * (s.c[1] + t * (s.c[2] + t * s.c[3]));
    y[i] = s.c[4] + t * (s.c[5] + t * (s.c[6] + t * s.c[7]));
    z[i] = s.c[8] + t * (s.c[9] + t * (s.c[10] + t * s.c[11]));
  }
}

}  // namespace retalho
