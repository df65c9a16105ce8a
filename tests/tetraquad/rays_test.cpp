// Rays: roots of cubics against the slow way, hits of a sphere, no ray out of a closed surface.
#include "retalho/tetraquad/rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "retalho/bernstein/segment.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/ray_tree.h"
#include "retalho/tetraquad/tight_box.h"
#include "support/sample_tetraquad.h"
#include "support/support.h"
#include "tetraquad/shapes.h"

namespace retalho {
namespace {

Vec3 on_sphere(test::Random& random) {
  while (true) {
    const Vec3 d = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm(d) < 1 && norm(d) > 0.1) return normalized(d);
  }
}

TEST(FirstRoot, IsTheSmallestOneThatSubdivisionFinds) {
  test::Random random(41);
  int found = 0;
  for (int n = 0; n < 20000; ++n) {
    std::array<double, 4> b;
    for (double& c : b) c = random.uniform(-1, 1);
    const double s = first_root(b);
    std::vector<BernsteinRoot> slow = roots(b);
    if (slow.empty()) {
      EXPECT_EQ(s, -1);
      continue;
    }
    if (!slow.front().simple) continue;
    ASSERT_GE(s, 0);
    EXPECT_NEAR(s, slow.front().t, 1e-9);
    ++found;
  }
  EXPECT_GT(found, 10000);
  EXPECT_EQ(first_root({1, 1, 1, 1}), -1);
  EXPECT_EQ(first_root({0, 0, 0, 0}), -1);
  EXPECT_NEAR(first_root({-1, -1.0 / 3, 1.0 / 3, 1}), 0.5, 1e-15);
}

TEST(FirstRoot, OfAGrazingRayToo) {
  // (s - m)^2 = d^2: two roots that lie ever closer together.
  double worst = 0;
  test::Random random(42);
  for (int n = 0; n < 20000; ++n) {
    const double m = random.uniform(0.3, 0.7), d = std::pow(10.0, random.uniform(-5, -1));
    const double a = m * m - d * d, b = a - m, c = a - 2 * m + 1;  // as a quadratic; then raised to degree 3
    const double s = first_root({a, (a + 2 * b) / 3, (2 * b + c) / 3, c});
    if (s < 0) continue;  // the dip is below the test's resolution
    worst = std::max(worst, std::abs(s - (m - d)));
  }
  EXPECT_LT(worst, 1e-9);
}

class RaysOnSplits : public testing::TestWithParam<TetSplit> {};
INSTANTIATE_TEST_SUITE_P(Both, RaysOnSplits, testing::Values(TetSplit::five, TetSplit::kuhn));

TEST_P(RaysOnSplits, HitASphereWhereItIs) {
  const TetraQuad surface = test::sample_tetraquad(GetParam(), 3);
  const TetraQuadField field(surface);
  test::Random random(42);
  for (const int halvings : {0, 6}) {
    const TetraQuadRays rays(field, halvings);
    for (int n = 0; n < 20000; ++n) {
      const Vec3 origin = 3 * on_sphere(random),
                 direction = random.uniform(0.1, 10) * (0.8 * on_sphere(random) - origin);
      const Vec3 m = origin - Vec3{0.1, 0, 0};
      const double a = norm2(direction), h = dot(m, direction), c = norm2(m) - 0.64, root2 = h * h - a * c;
      const auto hit = rays.first(origin, direction);
      if (root2 < 1e-9 * a) continue;  // grazing
      if (root2 < 0) {
        EXPECT_FALSE(hit);
        continue;
      }
      const double t = (-h - std::sqrt(root2)) / a;
      ASSERT_TRUE(hit.has_value());
      EXPECT_NEAR(hit->t, t, 1e-9);
      const Vec3 normal = normalized(field.gradient(hit->tet, hit->b).gradient);
      EXPECT_LT(norm(normal - (origin + t * direction - Vec3{0.1, 0, 0}) / 0.8), 1e-9);
      // Behind the hit: the far side.
      const auto next = rays.first(origin, direction, hit->t + 1e-6);
      ASSERT_TRUE(next.has_value());
      EXPECT_NEAR(next->t, (-h + std::sqrt(root2)) / a, 1e-9);
      EXPECT_FALSE(rays.first(origin, direction, 0, hit->t - 1e-6));
    }
  }
}

TEST_P(RaysOnSplits, NoneLeavesAClosedSurface) {
  const TetraQuad surface =
      fit_tetraquad(test::sphere_points(4000, {1, 2, 3}, 0.5), {.resolution = 8, .split = GetParam(), .bending = 0});
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field);
  test::Random random(43);
  double worst = 0;
  for (int n = 0; n < 200000 * test::soak(); ++n) {
    const Vec3 origin = Vec3{1, 2, 3} + 0.3 * random.uniform() * on_sphere(random);
    Vec3 direction = on_sphere(random);
    if (n % 3 == 0) direction = {std::round(2 * direction.x), std::round(2 * direction.y), std::round(2 * direction.z)};
    if (norm2(direction) == 0) continue;
    const auto hit = rays.first(origin, direction);
    ASSERT_TRUE(hit.has_value()) << n;
    worst = std::max(worst, std::abs(norm(origin + hit->t * direction - Vec3{1, 2, 3}) - 0.5));
  }
  EXPECT_LT(worst, 1e-6);
}

TEST(Rays, FromFarAwayAndOnesThatHitNothing) {
  const TetraQuad surface = test::sample_tetraquad(TetSplit::five, 2);
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field);
  const auto hit = rays.first({1e7, 0.01, 0.02}, {-1, 0, 0});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(1e7 - hit->t, 0.1 + std::sqrt(0.64 - 0.0005), 1e-6);
  EXPECT_FALSE(rays.first({1e7, 0.01, 0.02}, {1, 0, 0}));
  EXPECT_FALSE(rays.first({0, 0, 0}, {0, 0, 0}));
  EXPECT_FALSE(rays.first({NAN, 0, 0}, {1, 0, 0}));
  EXPECT_FALSE(rays.first({5, 5, 5}, {1, 0, 0}));
}

/// Rays of every kind at a model about the origin: from outside and inside, along axes and through lattice points.
RayQuery some_ray(test::Random& random, int n, double reach) {
  Vec3 origin = random.uniform(0, 2) * reach * on_sphere(random), direction = on_sphere(random);
  if (n % 4 == 0) origin = {std::round(origin.x), std::round(origin.y), std::round(origin.z)};
  if (n % 3 == 0) direction = -1 * origin + 0.7 * reach * on_sphere(random);
  if (n % 5 == 0) direction = {std::round(direction.x), std::round(direction.y), std::round(direction.z)};
  if (norm2(direction) == 0) direction = {0, 0, 1};
  direction = normalized(direction);
  const double from = n % 7 == 0 ? 0.3 * reach : 0, to = n % 11 == 0 ? reach : std::numeric_limits<double>::infinity();
  return {{origin.x, origin.y, origin.z}, {direction.x, direction.y, direction.z}, from, to, -1, {}};
}

TEST_P(RaysOnSplits, GiveTheBytesOfLookingAtEveryTetrahedron) {
  const TetraQuad surface =
      fit_tetraquad(test::sphere_points(4000, {1, 2, 3}, 0.5), {.resolution = 6, .split = GetParam()});
  const TetraQuadField field(surface);
  test::Random random(44);
  for (const int halvings : {0, 3, 9}) {
    const RayTree tree = make_ray_tree(field, halvings, {});
    ASSERT_GT(tree.prims.size(), 100U);
    int hits = 0;
    for (int n = 0; n < 5000; ++n) {
      const RayQuery query = some_ray(random, n, 3);
      RayQuery slow = query, generic = query;
      meet_all_prims(tree.scene(), tree.prims.size(), slow);
      walk_rays_generic(tree.scene(), generic);
      std::vector<RayQuery> walked = {generic};
#if defined(__x86_64__)
      if (__builtin_cpu_supports("avx2")) {
        walked.push_back(query);
        walk_rays_avx2(tree.scene(), walked.back());
      }
#endif
      for (const RayQuery& fast : walked) {
        ASSERT_EQ(fast.prim, slow.prim) << n;
        if (slow.prim < 0) continue;
        ASSERT_EQ(fast.to, slow.to) << n;
        for (int i = 0; i < 4; ++i) ASSERT_EQ(fast.b[i], slow.b[i]) << n;
      }
      hits += slow.prim >= 0 ? 1 : 0;
    }
    EXPECT_GT(hits, 1000);
  }
}

/// The first hit by subdivision, in every tetrahedron; NaN: none. `grazing`: a root that is not simple was met.
double slow_hit(const TetraQuadField& field, Vec3 origin, Vec3 direction, bool* grazing) {
  const TetMesh& mesh = field.surface().mesh;
  double first = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const TetBarycentric o = field.frame(t).barycentric((origin - mesh.origin) / mesh.step),
                         d = field.frame(t).direction(direction / mesh.step);
    double t0 = 0, t1 = 1e3;
    for (std::size_t i = 0; i < 4; ++i) {
      if (d[i] > 0) t0 = std::max(t0, -o[i] / d[i]);
      if (d[i] < 0) t1 = std::min(t1, -o[i] / d[i]);
      if (d[i] == 0 && o[i] < 0) t1 = -1;
    }
    if (t0 >= t1) continue;
    TetBarycentric a, b;
    for (std::size_t i = 0; i < 4; ++i) {
      a[i] = o[i] + t0 * d[i];
      b[i] = o[i] + t1 * d[i];
    }
    const TetCubic& c = field.ordinates(t);
    const std::array<double, 4> along = {blossom(c, a, a, a), blossom(c, a, a, b), blossom(c, a, b, b),
                                         blossom(c, b, b, b)};
    for (const BernsteinRoot& root : roots(along)) {
      *grazing = *grazing || !root.simple;
      first = std::fmin(first, t0 + root.t * (t1 - t0));
    }
  }
  return first;
}

TEST_P(RaysOnSplits, HitWhatSubdivisionOfEveryTetrahedronFinds) {
  // Two balls that touch softly: some rays meet four sheets.
  TetraQuadFitOptions options{.resolution = 6, .split = GetParam()};
  PointCloud points = test::sphere_points(1500, {0, 0, 0}, 0.5);
  const PointCloud other = test::sphere_points(1500, {0.8, 0.3, 0.1}, 0.4);
  points.positions.insert(points.positions.end(), other.positions.begin(), other.positions.end());
  points.normals.insert(points.normals.end(), other.normals.begin(), other.normals.end());
  const TetraQuad surface = fit_tetraquad(points, options);
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field);
  test::Random random(45);
  int hits = 0;
  for (int n = 0; n < 1500; ++n) {
    const Vec3 origin = Vec3{0.4, 0.1, 0} + 1.5 * on_sphere(random),
               direction = Vec3{0.4, 0.1, 0} + 0.7 * on_sphere(random) - origin;
    bool grazing = false;
    const double slow = slow_hit(field, origin, direction, &grazing);
    const auto fast = rays.first(origin, direction);
    if (grazing) continue;
    ASSERT_EQ(fast.has_value(), !std::isnan(slow)) << n;
    if (!fast) continue;
    EXPECT_NEAR(fast->t, slow, 1e-8) << n;
    ++hits;
  }
  EXPECT_GT(hits, 500);
}

TEST(TightBoxes, HoldAllZeros) {
  test::Random random(46);
  const auto inside = [&random] {
    TetBarycentric b;
    double sum = 0;
    for (double& x : b) sum += x = -std::log(random.uniform(1e-9, 1));
    for (double& x : b) x /= sum;
    return b;
  };
  int zeros = 0;
  for (int n = 0; n < 1000; ++n) {
    std::array<Vec3, 4> x;
    for (Vec3& p : x) p = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
    TetCubic c;
    const double offset = random.uniform(-1, 1);
    for (double& o : c) o = offset + random.uniform(-1, 1);
    const int halvings = n % 10;
    const auto box = tight_box(c, x, halvings);
    for (int ray = 0; ray < 40; ++ray) {
      const TetBarycentric a = inside(), b = inside();
      const std::array<double, 4> along = {blossom(c, a, a, a), blossom(c, a, a, b), blossom(c, a, b, b),
                                           blossom(c, b, b, b)};
      for (const BernsteinRoot& root : roots(along)) {
        if (!root.simple) continue;
        ASSERT_TRUE(box.has_value());
        Vec3 p{};
        for (std::size_t i = 0; i < 4; ++i) p = p + ((1 - root.t) * a[i] + root.t * b[i]) * x[i];
        EXPECT_TRUE(p.x > box->low.x - 1e-9 && p.y > box->low.y - 1e-9 && p.z > box->low.z - 1e-9);
        EXPECT_TRUE(p.x < box->high.x + 1e-9 && p.y < box->high.y + 1e-9 && p.z < box->high.z + 1e-9);
        ++zeros;
      }
    }
  }
  EXPECT_GT(zeros, 3000);
}

TEST(TightBoxes, AreThoseOfAPlaneWhereTheCubicIsOne) {
  const std::array<Vec3, 4> x = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}};
  TetCubic c;
  for (std::size_t n = 0; n < 20; ++n) {
    c[n] = -1;  // z = 1
    for (const int i : kTet.cubic[n]) c[n] += x[static_cast<std::size_t>(i)].z / 3;
  }
  const auto box = tight_box(c, x, 9);
  ASSERT_TRUE(box);
  EXPECT_LT(norm(box->low - Vec3{0, 0, 1}), 1e-9);
  EXPECT_LT(norm(box->high - Vec3{3, 3, 1}), 1e-9);
  EXPECT_LT(norm(tight_box(c, x, 0)->high - Vec3{4, 4, 4}), 1e-15);
  for (double& o : c) o += 2;
  EXPECT_FALSE(tight_box(c, x, 9));
}

TEST(RayNodes, NameEveryBoxOnceAndFitTheStack) {
  test::Random random(47);
  for (const int kind : {0, 1, 2}) {
    std::vector<RayBox> boxes;
    for (int n = 0; n < 3000; ++n) {
      // Anywhere; all the same; ever smaller, which cuts off one box at a time.
      const auto at = static_cast<float>(kind == 0   ? random.uniform(-1, 1)
                                         : kind == 1 ? 0.5
                                                     : std::ldexp(1.0, -n / 20));
      boxes.push_back({{at, at, at}, {at, at + 0.01F * at * at, 2 * at + 0.001F}});
    }
    const std::vector<RayNode> nodes = build_ray_nodes(boxes);
    std::vector<int> named(boxes.size(), 0);
    std::size_t deepest = 0;
    const std::function<void(std::uint32_t, std::size_t)> visit = [&](std::uint32_t node, std::size_t depth) {
      deepest = std::max(deepest, depth);
      for (int i = 0; i < kRayWidth; ++i) {
        const auto& plane = nodes[node].plane;
        if (plane[0][i] > plane[3][i]) continue;
        const std::uint32_t child = nodes[node].child[i];
        if ((child & kRayLeaf) == 0) {
          for (int j = 0; j < kRayWidth; ++j)
            for (int k = 0; k < 3; ++k) {
              if (nodes[child].plane[0][j] > nodes[child].plane[3][j]) continue;
              EXPECT_LE(plane[k][i], nodes[child].plane[k][j]);
              EXPECT_GE(plane[3 + k][i], nodes[child].plane[3 + k][j]);
            }
          visit(child, depth + 1);
          continue;
        }
        ++named[child & ~kRayLeaf];
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(plane[k][i], boxes[child & ~kRayLeaf].low[k]);
      }
    };
    visit(0, 1);
    EXPECT_EQ(std::count(named.begin(), named.end(), 1), static_cast<std::ptrdiff_t>(boxes.size()));
    EXPECT_LT((kRayWidth - 1) * deepest + kRayWidth, kRayStack);
  }
  EXPECT_TRUE(build_ray_nodes({}).empty());
}

}  // namespace
}  // namespace retalho
