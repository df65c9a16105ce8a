// TetraQuad surfaces in model files.
#include <gtest/gtest.h>

#include <cmath>

#include "retalho/core/error.h"
#include "retalho/model/check.h"
#include "retalho/model/model.h"
#include "support/sample_tetraquad.h"
#include "support/support.h"

namespace retalho {
namespace {

/// Gives the quadrics digits to keep, saves, and loads again.
TetraQuad roughened_and_back(TetraQuad& surface, unsigned seed) {
  test::Random random(seed);
  for (Quadric& q : surface.quadrics)
    for (double& c : q) c += random.uniform(-1e-3, 1e-3);
  const test::ScratchFolder folder;
  save_model(surface, folder / "s.retalho");
  const auto again = std::get<TetraQuad>(load_model(folder / "s.retalho"));
  EXPECT_EQ(again.quadrics, surface.quadrics);
  EXPECT_EQ(again.mesh.tets, surface.mesh.tets);
  return again;
}

TEST(TetraQuadModel, ComesBackToTheBit) {
  for (const TetSplit split : {TetSplit::five, TetSplit::kuhn}) {
    TetraQuad surface = test::sample_tetraquad(split);
    surface.georef.crs_wkt = "LOCAL_CS[\"x\"]";
    surface.georef.origin_x = 4.5e6;
    const TetraQuad again = roughened_and_back(surface, 31);
    EXPECT_EQ(again.mesh.places, surface.mesh.places);
    EXPECT_EQ(again.mesh.origin, surface.mesh.origin);
    EXPECT_EQ(again.mesh.step, surface.mesh.step);
    EXPECT_EQ(again.mesh.split, split);
    EXPECT_EQ(again.georef.origin_x, 4.5e6);
    EXPECT_EQ(again.georef.crs_wkt, surface.georef.crs_wkt);
    EXPECT_EQ(encode_model(again), encode_model(surface));
  }
}

TEST(TetraQuadModel, AdaptiveOnesComeBackToTheBit) {
  TetraQuad surface = test::sample_adaptive_tetraquad(5);
  surface.georef.origin_y = 5.5e6;
  const TetraQuad again = roughened_and_back(surface, 32);
  EXPECT_EQ(again.mesh.lattice, surface.mesh.lattice);
  EXPECT_EQ(again.mesh.step, surface.mesh.step);
  EXPECT_EQ(again.georef.origin_y, 5.5e6);
  ASSERT_TRUE(again.mesh.forest);
  EXPECT_EQ(again.mesh.forest->halved(), surface.mesh.forest->halved());
  EXPECT_EQ(encode_model(again), encode_model(surface));
  // Found in the same tetrahedra, with the same values.
  const TetraQuadField before(surface), after(again);
  test::Random random(33);
  std::size_t inside = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    EXPECT_EQ(again.mesh.locate(p), surface.mesh.locate(p));
    const auto a = before.jet(p), b = after.jet(p);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      EXPECT_EQ(a->value, b->value);
    }
    inside += a ? 1 : 0;
  }
  EXPECT_GT(inside, 200U);
}

TEST(TetraQuadModel, AdaptiveOnesWithFaultsAreNotSaved) {
  TetraQuad surface = test::sample_adaptive_tetraquad();
  std::swap(surface.mesh.tets[0], surface.mesh.tets[1]);
  EXPECT_THROW(encode_model(surface), BadInput);
  surface = test::sample_adaptive_tetraquad();
  surface.mesh.tet_of_leaf.erase(surface.mesh.tet_of_leaf.begin());
  EXPECT_THROW(encode_model(surface), BadInput);
  surface = test::sample_adaptive_tetraquad();
  surface.quadrics.back()[9] = INFINITY;
  EXPECT_THROW(encode_model(surface), BadInput);
}

TEST(TetraQuadModel, OnesWithFaultsAreNotSaved) {
  TetraQuad surface = test::sample_tetraquad();
  surface.quadrics[3][4] = NAN;
  EXPECT_THROW(encode_model(surface), BadInput);
  surface = test::sample_tetraquad();
  surface.quadrics.pop_back();
  EXPECT_THROW(encode_model(surface), BadInput);
  surface = test::sample_tetraquad();
  surface.mesh.step = 0;
  EXPECT_THROW(encode_model(surface), BadInput);
  EXPECT_THROW(encode_model(TetraQuad{}), BadInput);
}

}  // namespace
}  // namespace retalho
