#include "retalho/terrain/spline_tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "retalho/core/parallel.h"
#include "retalho/terrain/tangent_kernels.h"

namespace retalho {
namespace {

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
  std::array<double, 2 * kSplineHalo + 1> rest{};
  const int size = last - first + 1;
  // A run that ends exactly kSplineHalo away counts as cut there: what lies behind is not looked at.
  const bool starts = at - first < kSplineHalo, stops = last - at < kSplineHalo;
  const auto& upper = starts ? pivots(ends) : cut_pivots();
  if (starts)
    rest[0] =
        ends == TangentEnds::not_a_knot ? (-5 * value(0) + 4 * value(1) + value(2)) / 2 : 1.5 * (value(1) - value(0));
  const auto place = [](int k) { return static_cast<std::size_t>(k); };
  for (int k = 1; k + 1 < size; ++k)
    rest[place(k)] = (3 * (value(first + k + 1) - value(first + k - 1)) - rest[place(k - 1)]) * upper[place(k)];
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

/// Lines side by side without voids, kLongRun samples long at least: sample k of line l at z[stride * k + across * l],
/// its tangent likewise in m. Sets the tangents of [first, last) that are within kSplineHalo of the lines' ends.
void set_ends(const double* z, std::ptrdiff_t stride, std::ptrdiff_t across, std::size_t lines, int n, RowRange wanted,
              TangentEnds ends, double* m) {
  EndSamples samples;
  EndTangents tangents;
  const auto work = [&](int from, int to, std::ptrdiff_t samples_from, std::ptrdiff_t tangents_from, auto&& solve) {
    if (from >= to) return;
    for (std::size_t l = 0; l < lines; l += kEndLanes) {
      const std::size_t count = std::min(kEndLanes, lines - l);
      const auto beside = across * static_cast<std::ptrdiff_t>(l);
      for (std::size_t k = 0; k < samples.size(); ++k)
        for (std::size_t i = 0; i < kEndLanes; ++i)  // behind the last line: the last one again
          samples[k][i] = z[stride * (samples_from + static_cast<std::ptrdiff_t>(k)) + beside +
                            across * static_cast<std::ptrdiff_t>(std::min(i, count - 1))];
      solve(samples, ends, tangents);
      for (std::ptrdiff_t k = from; k < to; ++k)
        for (std::size_t i = 0; i < count; ++i)
          m[stride * k + beside + across * static_cast<std::ptrdiff_t>(i)] =
              tangents[static_cast<std::size_t>(k - tangents_from)][i];
    }
  };
  work(wanted.first, std::min(kSplineHalo, wanted.last), 0, 0, first_tangents);
  work(std::max(n - kSplineHalo, wanted.first), wanted.last, n - kLongRun, n - kSplineHalo, last_tangents);
}

}  // namespace

void tangents_along_rows(std::span<const double> values, GridShape shape, const Mask& valid, TangentEnds ends,
                         RowRange rows, std::span<double> out, const Context& context) {
  const int columns = shape.columns;
  const auto count = static_cast<std::size_t>(rows.last - rows.first);
  const auto inner = [](const double* z, double* m, int n) {
    if (n > 2 * kSplineHalo)
      inner_tangents(z + kSplineHalo, 1, static_cast<std::size_t>(n - 2 * kSplineHalo), m + kSplineHalo);
  };
  parallel_chunks(count, 16, context, [&](std::size_t from, std::size_t to) {
    const std::size_t start = (from + static_cast<std::size_t>(rows.first)) * static_cast<std::size_t>(columns);
    const double* z = values.data() + start;
    double* m = out.data() + start;
    if (valid.empty() && columns >= kLongRun) {
      set_ends(z, 1, columns, to - from, columns, {0, columns}, ends, m);
      for (std::size_t i = from; i < to; ++i, z += columns, m += columns) inner(z, m, columns);
      return;
    }
    for (std::size_t i = from; i < to; ++i, z += columns, m += columns) {
      std::fill(m, m + columns, 0.0);
      const auto is_valid = [&](int c) { return valid.empty() || valid.get(c, static_cast<int>(i) + rows.first); };
      for_each_run(columns, is_valid, [&](int begin, int end) {
        const int n = end - begin;
        inner(z + begin, m + begin, n);
        const int inner_begin = std::min(n, kSplineHalo), inner_end = std::max(inner_begin, n - kSplineHalo);
        for (int k = 0; k < inner_begin; ++k) m[begin + k] = window_tangent(z + begin, 1, n, k, ends);
        for (int k = inner_end; k < n; ++k) m[begin + k] = window_tangent(z + begin, 1, n, k, ends);
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
    const auto copy = std::make_unique_for_overwrite<double[]>(kBlock * (kRows + 2 * kSplineHalo));
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
          std::copy(source, source + width, copy.get() + r * kBlock);
        }
        for (int r = 0; r < count; ++r)
          inner_tangents(copy.get() + (r + kSplineHalo) * kBlock, kBlock, static_cast<std::size_t>(width),
                         m + stride * (top + r));
      }
      if (valid.empty() && rows >= kLongRun) {
        set_ends(z, stride, 1, static_cast<std::size_t>(width), rows, wanted, ends, m);
        continue;
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
