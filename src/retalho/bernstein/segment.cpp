#include "retalho/bernstein/segment.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace retalho {

namespace {

constexpr std::size_t kStackSize = 64;

/// The one root between the ends of a piece whose end values have opposite signs: Newton, kept inside a bracket.
double solve_bracketed(std::span<const double> b) {
  if (b.size() < 2) return 0;
  double low = 0, high = 1;
  const bool rising = b.front() < 0;
  double t = b.front() / (b.front() - b.back());
  const std::size_t n = b.size() - 1;
  std::array<double, kStackSize> stack;
  std::vector<double> heap(b.size() > kStackSize ? b.size() : 0);
  double* w = heap.empty() ? stack.data() : heap.data();
  for (int step = 0; step < 80; ++step) {
    std::copy(b.begin(), b.end(), w);
    for (std::size_t r = n; r > 1; --r)
      for (std::size_t i = 0; i < r; ++i) w[i] += t * (w[i + 1] - w[i]);
    const double slope = static_cast<double>(n) * (w[1] - w[0]);
    const double value = w[0] + t * (w[1] - w[0]);
    if (value == 0) return t;
    if ((value < 0) == rising)
      low = t;
    else
      high = t;
    double next = slope != 0 ? t - value / slope : -1;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - t) <= 1e-16 || high - low <= 1e-16) return next;
    t = next;
  }
  return t;
}

struct Stretch {
  double low, high;
  bool simple;
};

/// Subdivision below one piece. The workspace holds two rows for every level, so that nothing is allocated on the way.
class Isolation {
 public:
  Isolation(std::size_t size, double zero, double width)
      : size_(size), zero_(zero), width_(width), work_(size * 2 * kLevels) {}

  void run(std::span<const double> b) { visit(b, 0, 1, 0); }
  std::vector<Stretch>& found() { return found_; }

 private:
  static constexpr std::size_t kLevels = 64;

  int sign(double v) const { return v > zero_ ? 1 : v < -zero_ ? -1 : 0; }

  void visit(std::span<const double> b, double low, double high, std::size_t level) {
    const int first = sign(b.front()), last = sign(b.back());
    if (first == 0) found_.push_back({low, low, false});
    if (last == 0) found_.push_back({high, high, false});
    int previous = 0, changes = 0;
    bool doubtful = false, zero_between = false;
    for (const double v : b) {
      const int s = sign(v);
      if (s == 0) {
        zero_between = previous != 0;
        continue;
      }
      if (previous != 0 && s != previous) ++changes;
      if (zero_between && s == previous) doubtful = true;  // the sign of the small one matters: look closer
      zero_between = false;
      previous = s;
    }
    if (previous == 0) {  // nothing but rounding on the whole piece
      found_.push_back({low, high, false});
      return;
    }
    if (changes == 0 && !doubtful) return;
    if (changes == 1 && !doubtful && first != 0 && last != 0) {
      const double t = low + solve_bracketed(b) * (high - low);
      found_.push_back({t, t, true});
      return;
    }
    if (high - low <= width_ || level + 1 >= kLevels) {
      found_.push_back({low, high, false});
      return;
    }
    const std::span<double> left(work_.data() + 2 * level * size_, size_), right(left.data() + size_, size_);
    subdivide(b, 0.5, left, right);
    const double middle = 0.5 * (low + high);
    visit(left, low, middle, level + 1);
    visit(right, middle, high, level + 1);
  }

  std::size_t size_;
  double zero_, width_;
  std::vector<double> work_;
  std::vector<Stretch> found_;
};

}  // namespace

double binomial(int n, int k) {
  if (k < 0 || k > n) return 0;
  k = std::min(k, n - k);
  double c = 1;
  for (int i = 1; i <= k; ++i) c = c * (n - k + i) / i;
  return c;
}

double evaluate(std::span<const double> b, double t) {
  if (b.empty()) return 0;
  std::array<double, kStackSize> stack;
  std::vector<double> heap(b.size() > kStackSize ? b.size() : 0);
  double* w = heap.empty() ? stack.data() : heap.data();
  std::copy(b.begin(), b.end(), w);
  const double s = 1 - t;
  for (std::size_t r = b.size() - 1; r > 0; --r)
    for (std::size_t i = 0; i < r; ++i) w[i] = s * w[i] + t * w[i + 1];
  return w[0];
}

void subdivide(std::span<const double> b, double t, std::span<double> left, std::span<double> right) {
  assert(left.size() == b.size() && right.size() == b.size());
  std::copy(b.begin(), b.end(), right.begin());
  const double s = 1 - t;
  const std::size_t n = b.size() - 1;
  for (std::size_t r = 0; r <= n; ++r) {
    left[r] = right[0];
    for (std::size_t i = 0; i + r < n; ++i) right[i] = s * right[i] + t * right[i + 1];
  }
}

Bernstein derivative(std::span<const double> b) {
  if (b.size() <= 1) return {0.0};
  Bernstein d(b.size() - 1);
  const double n = static_cast<double>(b.size() - 1);
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = n * (b[i + 1] - b[i]);
  return d;
}

Bernstein elevate(std::span<const double> b) {
  const std::size_t n = b.size();
  Bernstein e(n + 1);
  e.front() = b.front();
  e.back() = b.back();
  for (std::size_t i = 1; i < n; ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(n);
    e[i] = s * b[i - 1] + (1 - s) * b[i];
  }
  return e;
}

Bernstein elevate_to(std::span<const double> b, int degree) {
  Bernstein e(b.begin(), b.end());
  while (static_cast<int>(e.size()) < degree + 1) e = elevate(e);
  return e;
}

Bernstein product(std::span<const double> a, std::span<const double> b) {
  const int m = static_cast<int>(a.size()) - 1, n = static_cast<int>(b.size()) - 1;
  Bernstein c(a.size() + b.size() - 1, 0.0);
  std::array<double, 3 * kStackSize> stack;
  std::vector<double> heap(c.size() > kStackSize ? 3 * c.size() : 0);
  double* ca = heap.empty() ? stack.data() : heap.data();  // rows of Pascal's triangle
  double* cb = ca + c.size();
  double* cc = cb + c.size();
  const auto pascal = [](double* row, int degree) {
    row[0] = 1;
    for (int i = 1; i <= degree; ++i) row[i] = row[i - 1] * (degree - i + 1) / i;
  };
  pascal(ca, m);
  pascal(cb, n);
  pascal(cc, m + n);
  for (int i = 0; i <= m; ++i) {
    const double scaled = ca[i] * a[static_cast<std::size_t>(i)];
    for (int j = 0; j <= n; ++j) c[static_cast<std::size_t>(i + j)] += scaled * cb[j] * b[static_cast<std::size_t>(j)];
  }
  for (int k = 0; k <= m + n; ++k) c[static_cast<std::size_t>(k)] /= cc[k];
  return c;
}

Bernstein sum(std::span<const double> a, std::span<const double> b, double s) {
  const int degree = static_cast<int>(std::max(a.size(), b.size())) - 1;
  Bernstein c = elevate_to(a, degree);
  const Bernstein d = elevate_to(b, degree);
  for (std::size_t i = 0; i < c.size(); ++i) c[i] += s * d[i];
  return c;
}

double integral(std::span<const double> b) {
  double total = 0;
  for (const double v : b) total += v;
  return total / static_cast<double>(b.size());
}

Bernstein power_to_bernstein(std::span<const double> a) {
  const int n = static_cast<int>(a.size()) - 1;
  Bernstein b(a.size(), 0.0);
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= i; ++k)
      b[static_cast<std::size_t>(i)] += binomial(i, k) / binomial(n, k) * a[static_cast<std::size_t>(k)];
  return b;
}

std::vector<double> bernstein_to_power(std::span<const double> b) {
  // Forward differences: a[k] = C(n, k) * (k-th difference at 0).
  std::vector<double> d(b.begin(), b.end()), a(b.size());
  const int n = static_cast<int>(b.size()) - 1;
  for (int k = 0; k <= n; ++k) {
    a[static_cast<std::size_t>(k)] = binomial(n, k) * d[0];
    for (int i = 0; i + k < n; ++i)
      d[static_cast<std::size_t>(i)] = d[static_cast<std::size_t>(i) + 1] - d[static_cast<std::size_t>(i)];
  }
  return a;
}

std::pair<double, double> bounds(std::span<const double> b) {
  const auto [low, high] = std::minmax_element(b.begin(), b.end());
  return {*low, *high};
}

std::vector<BernsteinRoot> roots(std::span<const double> b, const RootOptions& options) {
  assert(!b.empty());
  double largest = 0;
  for (const double v : b) largest = std::max(largest, std::abs(v));
  const double zero = options.zero >= 0 ? options.zero : 4 * static_cast<double>(b.size()) * 0x1p-53 * largest;
  if (largest <= zero) return {{0.5, 0.5, false}};
  Isolation isolation(b.size(), zero, options.width);
  isolation.run(b);
  auto& found = isolation.found();
  std::sort(found.begin(), found.end(), [](const Stretch& p, const Stretch& q) { return p.low < q.low; });
  std::vector<BernsteinRoot> result;
  for (std::size_t i = 0; i < found.size();) {
    Stretch all = found[i++];
    // Undecided stretches that touch are one; a simple root next to one stays apart unless it lies inside.
    while (i < found.size() && found[i].low <= all.high + (found[i].simple || all.simple ? 0 : options.width)) {
      all.high = std::max(all.high, found[i].high);
      all.simple = all.simple && found[i].simple && all.low == found[i].low;
      ++i;
    }
    result.push_back({0.5 * (all.low + all.high), 0.5 * (all.high - all.low), all.simple});
  }
  return result;
}

}  // namespace retalho
