// Pictures of patches: every style draws, sizes are kept, what is in front hides what is behind.
#include <gtest/gtest.h>

#include <algorithm>

#include "retalho/core/error.h"
#include "retalho/render/patch_picture.h"

namespace retalho::test {
namespace {

Patch flat(double z) {
  const auto line = [z](Vec3 a, Vec3 b) {
    a.z = b.z = z;
    return SideCurve(make_bezier(std::vector<Vec3>{a, b}, 1, 3));
  };
  return make_patch({line({0, 0, 0}, {1, 0, 0}), line({1, 0, 0}, {0, 1, 0}), line({0, 1, 0}, {0, 0, 0})},
                    {.divisions = {4, 4, 4}});
}

TEST(PatchPicture, EveryStyleDrawsInTheSizeAsked) {
  std::vector<Patch> patches;
  patches.push_back(flat(0));
  for (Vec3& p : patches[0].positions) p.z = 0;
  std::vector<PatchSurface> surfaces;
  surfaces.emplace_back(patches[0]);
  for (const PatchStyle style : {PatchStyle::shaded, PatchStyle::lines, PatchStyle::isophotes, PatchStyle::zebra,
                                 PatchStyle::gaussian, PatchStyle::mean}) {
    const Image image =
        draw_patches(patches, surfaces, {.style = style, .width = 120, .height = 90, .from = 0, .elevation = 90});
    EXPECT_EQ(image.width, 120);
    EXPECT_EQ(image.height, 90);
    const Rgb white{255, 255, 255};
    const auto inked = std::count_if(image.pixels.begin(), image.pixels.end(), [&](Rgb p) { return !(p == white); });
    EXPECT_GT(inked, 120 * 90 / 5);  // half of a square of 0.92 x 90 pixels
    EXPECT_LT(inked, 120 * 90 / 2);
    EXPECT_EQ(image.at(1, 1), white);
  }
  EXPECT_THROW(draw_patches(patches, surfaces, {.width = 5}), UsageError);
  EXPECT_THROW(draw_patches({}, {}), UsageError);
}

TEST(PatchPicture, LinesAreOfTheParameters) {
  std::vector<Patch> patches;
  patches.push_back(flat(0));
  std::vector<PatchSurface> surfaces;
  surfaces.emplace_back(patches[0]);
  PatchPictureOptions options{
      .style = PatchStyle::shaded, .width = 200, .height = 200, .elevation = 90, .sides = false};
  const Image plain = draw_patches(patches, surfaces, options);
  options.style = PatchStyle::lines;
  const Image lined = draw_patches(patches, surfaces, options);
  std::size_t darker = 0;
  for (std::size_t i = 0; i < plain.pixels.size(); ++i) darker += lined.pixels[i].g + 20 < plain.pixels[i].g ? 1 : 0;
  EXPECT_GT(darker, 500U);
  EXPECT_LT(darker, 200U * 200U / 4);
}

}  // namespace
}  // namespace retalho::test
