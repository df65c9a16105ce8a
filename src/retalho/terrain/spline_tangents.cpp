#include "retalho/terrain/spline_tangents.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "retalho/core/parallel.h"

namespace retalho {
namespace {

// m(k-1) + 4 m(k) + m(k+1) = 3 (z(k+1) - z(k-1)) on an endless row has the solution
// m(i) = c sum_k p^(k-1) (z(i+k) - z(i-k)), p = sqrt(3) - 2.
const double kDecay = std::sqrt(3.0) - 2;
const double kWeight = std::sqrt(3.0) / 2 * (1 - kDecay * kDecay);

/// The tangent at sample `at` of a run of `n` samples, near one of its ends (or both): the tridiagonal system of the
/// samples that are within kSplineHalo. Beyond a cut that is no end of the run the tangent counts as zero.
double window_tangent(const double* z, std::ptrdiff_t stride, int n, int at, TangentEnds ends) {
  if (n == 1) return 0;
  const auto value = [&](int k) { return z[stride * k]; };
  if (n == 2) return value(1) - value(0);
  if (n == 3 && ends == TangentEnds::not_a_knot) {
    const double middle = (value(2) - value(0)) / 2, bend = value(2) - 2 * value(1) + value(0);
    return at == 1 ? middle : at == 0 ? middle - bend : middle + bend;
  }
  const int first = std::max(0, at - kSplineHalo), last = std::min(n - 1, at + kSplineHalo);
  // Forward elimination: m(k) = rest[k] - upper[k] m(k+1).
  std::array<double, 2 * kSplineHalo + 1> upper{}, rest{};
  const int size = last - first + 1;
  // A run that ends exactly kSplineHalo away counts as cut there: what lies behind is not looked at.
  const bool starts = at - first < kSplineHalo, stops = last - at < kSplineHalo;
  if (starts) {
    if (ends == TangentEnds::not_a_knot) {
      upper[0] = 2;
      rest[0] = (-5 * value(0) + 4 * value(1) + value(2)) / 2;
    } else {
      upper[0] = 0.5;
      rest[0] = 1.5 * (value(1) - value(0));
    }
  }
  const auto place = [](int k) { return static_cast<std::size_t>(k); };
  for (int k = 1; k + 1 < size; ++k) {
    const double pivot = 1 / (4 - upper[place(k - 1)]);
    upper[place(k)] = pivot;
    rest[place(k)] = (3 * (value(first + k + 1) - value(first + k - 1)) - rest[place(k - 1)]) * pivot;
  }
  double m = 0;
  if (stops) {
    const double before = rest[place(size - 2)], slope = upper[place(size - 2)];
    if (ends == TangentEnds::not_a_knot) {
      const double right = (5 * value(n - 1) - 4 * value(n - 2) - value(n - 3)) / 2;  // m(n-1) + 2 m(n-2)
      m = (right - 2 * before) / (1 - 2 * slope);
    } else {
      const double right = 3 * (value(n - 1) - value(n - 2));  // 2 m(n-1) + m(n-2)
      m = (right - before) / (2 - slope);
    }
  }
  for (int k = size - 2; k >= at - first; --k) m = rest[place(k)] - upper[place(k)] * m;
  return m;
}

/// Calls run(begin, end) for each unbroken run of valid samples of a line.
template <class Valid, class Run>
void for_each_run(int n, const Valid& valid, const Run& run) {
  for (int begin = 0; begin < n;) {
    if (!valid(begin)) {
      ++begin;
      continue;
    }
    int end = begin + 1;
    while (end < n && valid(end)) ++end;
    run(begin, end);
    begin = end;
  }
}

}  // namespace

void tangents_along_rows(std::span<const double> values, GridShape shape, const Mask& valid, TangentEnds ends,
                         RowRange rows, std::span<double> out, const Context& context) {
  const int columns = shape.columns;
  const auto count = static_cast<std::size_t>(rows.last - rows.first);
  parallel_chunks(count, 16, context, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const std::size_t r = i + static_cast<std::size_t>(rows.first);
      const double* z = values.data() + r * static_cast<std::size_t>(columns);
      double* m = out.data() + r * static_cast<std::size_t>(columns);
      std::fill(m, m + columns, 0.0);
      const auto is_valid = [&](int c) { return valid.empty() || valid.get(c, static_cast<int>(r)); };
      for_each_run(columns, is_valid, [&](int begin, int end) {
        const int n = end - begin;
        const int inner_begin = std::min(n, kSplineHalo), inner_end = std::max(inner_begin, n - kSplineHalo);
        for (int k = 0; k < inner_begin; ++k) m[begin + k] = window_tangent(z + begin, 1, n, k, ends);
        for (int k = inner_end; k < n; ++k) m[begin + k] = window_tangent(z + begin, 1, n, k, ends);
        for (int block = inner_begin; block < inner_end; block += 512) {
          const int size = std::min(512, inner_end - block);
          const double* centre = z + begin + block;
          double* sum = m + begin + block;
          for (int k = kSplineHalo; k >= 1; --k)
            for (int x = 0; x < size; ++x) sum[x] = sum[x] * kDecay + (centre[x + k] - centre[x - k]);
          for (int x = 0; x < size; ++x) sum[x] *= kWeight;
        }
      });
    }
  });
}

void tangents_along_columns(std::span<const double> values, GridShape shape, const Mask& valid, TangentEnds ends,
                            RowRange wanted, std::span<double> out, const Context& context) {
  constexpr int kBlock = 64, kRows = 128;
  const int rows = shape.rows, columns = shape.columns;
  const int deep_first = std::max(kSplineHalo, wanted.first), deep_last = std::min(rows - kSplineHalo, wanted.last);
  const auto stride = static_cast<std::ptrdiff_t>(columns);
  const auto blocks = static_cast<std::size_t>((columns + kBlock - 1) / kBlock);
  parallel_chunks(blocks, 1, context, [&](std::size_t from, std::size_t to) {
    std::vector<double> copy(static_cast<std::size_t>(kBlock * (kRows + 2 * kSplineHalo)));
    for (std::size_t b = from; b < to; ++b) {
      const int left = static_cast<int>(b) * kBlock, width = std::min(kBlock, columns - left);
      const double* z = values.data() + left;
      double* m = out.data() + left;
      // The endless rule wherever the grid is deep enough; what is near an end or a void is done again below. Rows are
      // copied side by side first: a grid whose rows are a power of two long would use one corner of the cache only.
      for (int top = deep_first; top < deep_last; top += kRows) {
        const int count = std::min(kRows, deep_last - top);
        for (int r = 0; r < count + 2 * kSplineHalo; ++r) {
          const double* source = z + stride * (top - kSplineHalo + r);
          std::copy(source, source + width, copy.data() + r * kBlock);
        }
        for (int r = 0; r < count; ++r) {
          std::array<double, kBlock> sum{};
          const double* centre = copy.data() + (r + kSplineHalo) * kBlock;
          for (int k = kSplineHalo; k >= 1; --k) {
            const double* below = centre + k * kBlock;
            const double* above = centre - k * kBlock;
            for (std::size_t x = 0; x < kBlock; ++x) sum[x] = sum[x] * kDecay + (below[x] - above[x]);
          }
          double* row = m + stride * (top + r);
          for (int x = 0; x < width; ++x) row[x] = sum[static_cast<std::size_t>(x)] * kWeight;
        }
      }
      for (int x = 0; x < width; ++x) {
        const auto is_valid = [&](int r) { return valid.empty() || valid.get(left + x, r); };
        int done = wanted.first;
        const auto clear_to = [&](int row) {
          for (row = std::min(row, wanted.last); done < row; ++done) m[stride * done + x] = 0;
        };
        for_each_run(rows, is_valid, [&](int begin, int end) {
          clear_to(begin);
          const int n = end - begin;
          const int inner_begin = std::min(n, kSplineHalo), inner_end = std::max(inner_begin, n - kSplineHalo);
          const int asked = std::max(0, wanted.first - begin), stop = std::min(n, wanted.last - begin);
          const double* run = z + stride * begin + x;
          const auto set = [&](int k, int end_of_part) {
            for (; k < end_of_part; ++k) m[stride * (begin + k) + x] = window_tangent(run, stride, n, k, ends);
          };
          set(asked, std::min(inner_begin, stop));
          set(std::max(inner_end, asked), stop);
          done = std::max(done, end);
        });
        clear_to(rows);
      }
    }
  });
}

}  // namespace retalho
