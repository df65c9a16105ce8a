// Curves: nanoseconds a point, user CPU time, minimum of several runs, beside Boost's cardinal cubic B-spline and
// Eigen's spline module in the same run. `--value bezier` or `--value bspline` prints one figure as JSON.
#include <sys/resource.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/interpolators/cardinal_cubic_b_spline.hpp>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <unsupported/Eigen/Splines>

#include "retalho/curve/batch.h"
#include "retalho/curve/flatten.h"

namespace {

using namespace retalho;

double user_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

volatile double sink;

template <typename Body>
double nanoseconds(std::size_t points, const Body& body) {
  double best = 1e300;
  for (int run = 0; run < 9; ++run) {
    std::size_t done = 0;
    const double start = user_seconds();
    double now = start;
    while (now - start < 0.08) {
      for (int k = 0; k < 20; ++k) body(), done += points;
      now = user_seconds();
    }
    best = std::min(best, 1e9 * (now - start) / static_cast<double>(done));
  }
  return best;
}

/// Median number of segments over Wang's bound: 3000 random curves of degree 2 to 6, tolerances 1e-4 to 1e-1 of about
/// the size of the curve.
double wang_ratio() {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> ratio;
  for (int round = 0; round < 3000; ++round) {
    std::vector<Vec2> points;
    for (int i = 0; i <= 2 + round % 5; ++i) {
      const double x = 10 * normal(random), y = 10 * normal(random);
      points.push_back({x, y});
    }
    const Curve curve = make_bezier(points);
    const double tolerance = std::pow(10.0, -4 + 3 * unit(random));
    ratio.push_back(static_cast<double>(flatten(curve, tolerance).points.size() - 1) /
                    static_cast<double>(wang_steps(curve.segment(0), tolerance)));
  }
  std::nth_element(ratio.begin(), ratio.begin() + 1500, ratio.end());
  return ratio[1500];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[2], "wang") == 0) {
    std::printf("{\"value\": %.3f}\n", wang_ratio());
    return 0;
  }
  constexpr std::size_t kPoints = 4096;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> t(kPoints), u(kPoints), x(kPoints), y(kPoints), z(kPoints);
  for (double& v : t) v = unit(random);

  const std::array<Vec3, 4> control = {Vec3{0, 0, 0}, {1, 2, 1}, {3, 2, -1}, {4, 0, 2}};
  const double bezier = nanoseconds(kPoints, [&] {
    evaluate_cubic(control, t, x, y, z);
    sink = x[17] + y[18] + z[19];
  });

  BSpline spline;
  spline.dimension = 3;
  for (int i = 0; i < 64; ++i) spline.points.push_back({unit(random), unit(random), unit(random)});
  spline.knots = clamped_knots(64, 3);
  for (std::size_t i = 0; i < kPoints; ++i) u[i] = spline.begin() + t[i] * (spline.end() - spline.begin());
  const CubicEvaluator evaluator(to_curve(spline));
  const double bspline = nanoseconds(kPoints, [&] {
    evaluator(u, x, y, z);
    sink = x[17] + y[18] + z[19];
  });

  if (argc == 3 && std::strcmp(argv[1], "--value") == 0) {
    std::printf("{\"value\": %.3f}\n", std::strcmp(argv[2], "bspline") == 0 ? bspline : bezier);
    return 0;
  }

  std::vector<double> values(64);
  for (double& v : values) v = unit(random);
  const boost::math::interpolators::cardinal_cubic_b_spline<double> boost_spline(values.begin(), values.end(), 0.0,
                                                                                 1.0 / 63);
  const double boost = nanoseconds(kPoints, [&] {
    for (std::size_t i = 0; i < kPoints; ++i) x[i] = boost_spline(t[i]);
    sink = x[17];
  });
  using EigenSpline = Eigen::Spline<double, 3, 3>;
  Eigen::Matrix<double, 3, Eigen::Dynamic> eigen_points = Eigen::Matrix<double, 3, Eigen::Dynamic>::Random(3, 64);
  Eigen::RowVectorXd knots(68);
  for (Eigen::Index i = 0; i < 68; ++i) knots(i) = spline.knots[static_cast<std::size_t>(i)] / spline.end();
  const EigenSpline eigen_spline(knots, eigen_points);
  const double eigen = nanoseconds(kPoints, [&] {
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d p = eigen_spline(t[i]);
      x[i] = p.x(), y[i] = p.y(), z[i] = p.z();
    }
    sink = x[17];
  });
  const double de_boor = nanoseconds(kPoints, [&] {
    for (std::size_t i = 0; i < kPoints; ++i) x[i] = evaluate(spline, u[i]).x;
    sink = x[17];
  });

  std::printf("ns a point (user CPU time, minimum of 9 runs, random parameters)\n");
  std::printf("cubic Bezier, 3-D, batch                   %7.2f\n", bezier);
  std::printf("cubic B-spline, 64 points, 3-D, batch      %7.2f\n", bspline);
  std::printf("  one at a time (de Boor)                  %7.2f\n", de_boor);
  std::printf("  Boost cardinal cubic B-spline, a scalar  %7.2f   (3 scalars: %.2f, ratio %.1f)\n", boost, 3 * boost,
              3 * boost / bspline);
  std::printf("  Eigen Spline<double, 3, 3>               %7.2f   (ratio %.1f)\n", eigen, eigen / bspline);
  return 0;
}
