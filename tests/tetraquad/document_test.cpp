// Quadrics written by hand: the paper's examples, and what is refused.
#include "retalho/tetraquad/document.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "retalho/core/error.h"
#include "support/paths.h"
#include "support/support.h"

namespace retalho {
namespace {

std::string example(const std::string& name) {
  return (std::filesystem::path(test::source_folder()) / "examples" / "tetraquads" / name).string();
}

TEST(Quadrics, EveryExampleIsRead) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(example(""))) {
    const TetraQuad surface = read_quadrics(entry.path().string());
    const TetraQuadField field(surface);
    bool crossed = false;
    for (std::size_t t = 0; t < surface.mesh.tets.size(); ++t) crossed = crossed || field.crosses(t);
    EXPECT_TRUE(crossed) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 10U);
}

TEST(Quadrics, AreThoseOfTheCoordinates) {
  // The same quadric at every vertex is the function itself.
  const TetraQuad sphere = read_quadrics(example("sphere.json"));
  const TetraQuad hyperboloid = read_quadrics(example("hyperboloid.json"));
  const TetraQuadField f(sphere), g(hyperboloid);
  test::Random random(51);
  for (int n = 0; n < 300; ++n) {
    const Vec3 p = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const auto s = f.jet(p), h = g.jet(p);
    if (!s) continue;
    EXPECT_NEAR(s->value, norm2(p) - 0.3, 1e-13);
    EXPECT_LT(norm(s->gradient - 2 * p), 1e-13);
    EXPECT_NEAR(h->value, p.x * p.x - p.y * p.y + p.z * p.z - 0.1, 1e-13);
  }
}

TEST(Quadrics, ThePapersNormalsJumpAcrossItsFace) {
  // Figure 2.8: continuous on the common face, not smooth.
  const TetraQuad surface = read_quadrics(example("jump.json"));
  ASSERT_EQ(surface.mesh.tets.size(), 2U);
  const TetraQuadField field(surface);
  const HalfFaces faces(surface.mesh.tets, 5);
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (faces.neighbour(0, i) != 1) continue;
    TetBarycentric here{}, there{};
    for (std::size_t k = 0; k < 4; ++k) here[k] = k == i ? 0 : 1.0 / 3;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t l = 0; l < 4; ++l)
        if (surface.mesh.tets[1][l] == surface.mesh.tets[0][k]) there[l] = here[k];
    EXPECT_NEAR(field.jet(0, here).value, field.jet(1, there).value, 1e-14);
    largest = norm(field.jet(0, here).gradient - field.jet(1, there).gradient);
  }
  EXPECT_GT(largest, 0.01);
}

TEST(Quadrics, WhatIsWrongIsSaid) {
  EXPECT_THROW(read_quadrics("missing.json"), CannotRead);
  EXPECT_THROW(parse_quadrics("{"), CannotRead);
  for (const char* text : {"[]", "{}", R"({"tetrahedra": []})", R"({"tetrahedra": [[0,0,0,5]], "everywhere": {}})",
                           R"({"tetrahedra": [[0,0,0,0]]})", R"({"tetrahedra": [[0,0,0,0]], "everywhere": {"xxx": 1}})",
                           R"({"tetrahedra": [[0,0,0,0]], "everywhere": {"xx": "1"}})",
                           R"({"tetrahedra": [[0,0,0,0]], "everywhere": {}, "quadrics": [{"vertex": [9,9,9]}]})",
                           R"({"tetrahedra": [[0,0,0.5,0]], "everywhere": {}})",
                           R"({"tetrahedra": [[0,0,0,0]], "step": 0, "everywhere": {}})",
                           R"({"tetrahedra": [[0,0,0,0]], "split": "six", "everywhere": {}})"})
    EXPECT_THROW(parse_quadrics(text), BadInput) << text;
}

}  // namespace
}  // namespace retalho
