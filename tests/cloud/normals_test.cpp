// Normals of points without: spheres, tori, planes; all on one side; what cannot be known is said.
#include "retalho/cloud/normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "retalho/cloud/cloud.h"
#include "retalho/core/error.h"
#include "support/support.h"
#include "tetraquad/shapes.h"

namespace retalho {
namespace {

TEST(Normals, OfATorusAndASpherePointOutwards) {
  for (const bool sphere : {true, false}) {
    const PointCloud cloud = sphere ? test::sphere_points(4000, {5, 6, 7}, 2) : test::torus_points(8000, 4);
    NormalNotes notes;
    const std::vector<Vec3> normals = estimate_normals(cloud.positions, {}, &notes);
    double worst = 1;
    for (std::size_t k = 0; k < normals.size(); ++k) {
      EXPECT_NEAR(norm(normals[k]), 1, 1e-12);
      worst = std::min(worst, dot(normals[k], cloud.normals[k]));
    }
    EXPECT_GT(worst, 0.95);
    EXPECT_EQ(notes.parts, 1U);
    EXPECT_EQ(notes.agreement, 1);
    EXPECT_EQ(notes.undecided, 0U);
  }
}

TEST(Normals, EveryPartIsTurnedByItself) {
  PointCloud cloud = test::sphere_points(1500, {0, 0, 0}, 1);
  const PointCloud other = test::sphere_points(1500, {10, 0, 0}, 1, 8);
  cloud.positions.insert(cloud.positions.end(), other.positions.begin(), other.positions.end());
  cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
  NormalNotes notes;
  const std::vector<Vec3> normals = estimate_normals(cloud.positions, {}, &notes);
  EXPECT_EQ(notes.parts, 2U);
  for (std::size_t k = 0; k < normals.size(); ++k) EXPECT_GT(dot(normals[k], cloud.normals[k]), 0.9);
}

TEST(Normals, DoNotDependOnThreadsNorOnDoubles) {
  PointCloud cloud = test::torus_points(3000, 4);
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  const std::vector<Vec3> normals = estimate_normals(cloud.positions, {}, nullptr, one);
  EXPECT_EQ(normals, estimate_normals(cloud.positions, {}, nullptr, two));
  for (int n = 0; n < 500; ++n) cloud.positions.push_back(cloud.positions[7]);
  const std::vector<Vec3> doubled = estimate_normals(cloud.positions);
  EXPECT_TRUE(std::equal(normals.begin(), normals.end(), doubled.begin()));
  EXPECT_EQ(doubled.back(), normals[7]);
}

TEST(Normals, WhatCannotBeKnownIsZero) {
  NormalNotes notes;
  EXPECT_TRUE(estimate_normals({}, {}, &notes).empty());
  const std::vector<Vec3> line =
      estimate_normals({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {NAN, 0, 0}}, {}, &notes);
  EXPECT_EQ(notes.undecided, 5U);
  EXPECT_EQ(line[0], Vec3{});
  EXPECT_THROW(estimate_normals({}, {.neighbours = 2}), UsageError);
}

TEST(Normals, OfTheBunnyAgreeWithItsOwn) {
  RETALHO_DATA_FILE(file, "points/bunny.ply");
  const PointCloud cloud = read_points(file);
  NormalNotes notes;
  const std::vector<Vec3> normals = estimate_normals(cloud.positions, {}, &notes);
  std::size_t right = 0;
  for (std::size_t k = 0; k < normals.size(); ++k) right += dot(normals[k], cloud.normals[k]) > 0 ? 1 : 0;
  EXPECT_GT(static_cast<double>(right) / static_cast<double>(normals.size()), 0.995);
  EXPECT_GT(notes.agreement, 0.99);
}

}  // namespace
}  // namespace retalho
