// Pictures by ray casting: a ball is a disc, cuts cut, colours say what they promise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/render/tetraquad_picture.h"
#include "support/sample_tetraquad.h"

namespace retalho {
namespace {

std::size_t drawn(const Image& image) {
  return static_cast<std::size_t>(std::count_if(image.pixels.begin(), image.pixels.end(), [](Rgb c) {
    return c != Rgb{255, 255, 255};
  }));
}

TEST(TetraQuadPicture, CutsAreReadInTheCrs) {
  Georef georef;
  georef.origin_x = 100;
  georef.origin_y = 1000;
  const CutPlane below = parse_cut("x<100.5", georef), above = parse_cut("y>999", georef), level = parse_cut("z>-2");
  EXPECT_EQ(below.normal.x, 1);
  EXPECT_EQ(below.offset, 0.5);
  EXPECT_EQ(above.normal.y, -1);
  EXPECT_EQ(above.offset, 1);
  EXPECT_EQ(level.normal.z, -1);
  EXPECT_EQ(level.offset, 2);
  for (const char* wrong : {"", "x", "x<", "q<1", "x=1", "x<1m", "x<nan", "x<inf"})
    EXPECT_THROW(parse_cut(wrong), UsageError) << wrong;
}

TEST(TetraQuadPicture, ABallIsADisc) {
  const TetraQuad surface = test::sample_tetraquad(TetSplit::five, 2);
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field);
  const Image image = draw_tetraquad(field, rays, 200, 200);
  int left = 200, right = 0, top = 200, bottom = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x)
      if (image.at(x, y) != Rgb{255, 255, 255}) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
  EXPECT_NEAR(right - left, bottom - top, 3);
  const double radius = 0.25 * (right - left + bottom - top + 2);
  EXPECT_NEAR(static_cast<double>(drawn(image)) / (3.14159265 * radius * radius), 1, 0.05);
  Context one;
  one.threads = 1;
  EXPECT_EQ(draw_tetraquad(field, rays, 200, 200, {}, one).pixels, image.pixels);
}

TEST(TetraQuadPicture, CutsShowTheInsideAndLeaveTheRestOut) {
  const TetraQuad surface = test::sample_tetraquad(TetSplit::five, 2);
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field);
  TetraQuadPictureOptions options;
  options.from = 90;  // from the east, x > 0
  options.elevation = 0;
  const Image whole = draw_tetraquad(field, rays, 100, 100, options);
  options.cuts = {{{1, 0, 0}, 0.1}};
  const Image open = draw_tetraquad(field, rays, 100, 100, options);
  EXPECT_GT(whole.at(50, 50).b, 0.85 * whole.at(50, 50).r);  // stone
  EXPECT_LT(open.at(50, 50).b, 0.6 * open.at(50, 50).r);     // copper: the inside of the far half
  options.cuts = {{{0, 0, 1}, -5}};
  EXPECT_EQ(drawn(draw_tetraquad(field, rays, 100, 100, options)), 0U);
}

TEST(TetraQuadPicture, ASmoothFunctionHasNoJumpsAndABrokenOneHas) {
  TetraQuad surface = test::sample_tetraquad(TetSplit::five, 2);
  const HalfFaces faces(surface.mesh.tets, surface.mesh.lattice.size());
  const TetBarycentric b = {0.3, 0.3, 0.3, 0.1};
  double worst = 0;
  for (std::size_t t = 0; t < surface.mesh.tets.size(); ++t)
    worst = std::max(worst, normal_jump(TetraQuadField(surface), faces, t, b));
  EXPECT_LT(worst, 1e-5);
  for (std::size_t v = 0; v < surface.quadrics.size(); v += 2) surface.quadrics[v][0] += 0.3;
  worst = 0;
  for (std::size_t t = 0; t < surface.mesh.tets.size(); ++t)
    worst = std::max(worst, normal_jump(TetraQuadField(surface), faces, t, b));
  EXPECT_GT(worst, 1);
}

TEST(TetraQuadPicture, OptionsOutOfRangeAreRefused) {
  const TetraQuad surface = test::sample_tetraquad();
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field);
  EXPECT_THROW(draw_tetraquad(field, rays, 0, 10), UsageError);
  EXPECT_THROW(draw_tetraquad(field, rays, 10, 10, {.up = 'q'}), UsageError);
  EXPECT_THROW(draw_tetraquad(field, rays, 10, 10, {.elevation = 91}), UsageError);
  EXPECT_THROW(draw_tetraquad(field, rays, 10, 10, {.samples = 0}), UsageError);
}

}  // namespace
}  // namespace retalho
