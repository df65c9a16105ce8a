#include "retalho/curve/segment_forms.h"

namespace retalho {

SegmentForms segment_forms(const CurveSegment& segment) {
  SegmentForms forms;
  const std::size_t count = segment.points.size();
  for (auto& part : forms.a) part.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = segment.rational() ? segment.weights[i] * segment.points[i] : segment.points[i];
    forms.a[0][i] = p.x;
    forms.a[1][i] = p.y;
    forms.a[2][i] = p.z;
  }
  if (!segment.rational()) {
    forms.w = {1.0};
    forms.n = derivative(forms.a);
    return forms;
  }
  forms.w.assign(segment.weights.begin(), segment.weights.end());
  const Bernstein slope = derivative(forms.w);
  for (std::size_t k = 0; k < 3; ++k)
    forms.n[k] = sum(product(derivative(forms.a[k]), forms.w), product(forms.a[k], slope), -1);
  return forms;
}

BernsteinVector derivative(const BernsteinVector& v) {
  return {derivative(v[0]), derivative(v[1]), derivative(v[2])};
}

Bernstein dot(const BernsteinVector& a, const BernsteinVector& b) {
  return sum(sum(product(a[0], b[0]), product(a[1], b[1])), product(a[2], b[2]));
}

BernsteinVector cross(const BernsteinVector& a, const BernsteinVector& b) {
  return {sum(product(a[1], b[2]), product(a[2], b[1]), -1), sum(product(a[2], b[0]), product(a[0], b[2]), -1),
          sum(product(a[0], b[1]), product(a[1], b[0]), -1)};
}

std::vector<double> speed_extrema(const SegmentForms& forms) {
  std::vector<double> result;
  const Bernstein half = dot(forms.n, derivative(forms.n));
  for (const double v : half)
    if (v != 0) {
      for (const BernsteinRoot& root : roots(half)) result.push_back(root.t);
      break;
    }
  return result;
}

}  // namespace retalho
