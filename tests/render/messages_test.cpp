// What the room's pictures refuse, in its own words.
#include <gtest/gtest.h>

#include <filesystem>

#include "retalho/core/error.h"
#include "retalho/render/contour_sheet.h"
#include "retalho/render/curve_picture.h"
#include "retalho/render/patch_picture.h"
#include "retalho/render/tetraquad_picture.h"
#include "support/errors.h"
#include "support/sample_tetraquad.h"
#include "support/support.h"

namespace retalho::test {
namespace {

TEST(RenderMessages, AreThese) {
  const TetraQuad surface = sample_tetraquad();
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field, 6);
  const auto draw = [&](int side, const TetraQuadPictureOptions& options) {
    draw_tetraquad(field, rays, side, side, options);
  };
  expect_refused<UsageError>({
      {"a picture has 16 to 20000 pixels a side", [] { draw_patches({}, {}, {.width = 5}); }},
      {"there is no patch to draw", [] { draw_patches({}, {}); }},
      {"a picture of 1 to 20000 pixels a side", [&] { draw(0, {}); }},
      {"a field of view of 1 to 120 degrees", [&] { draw(9, {.field_of_view = 0}); }},
      {"1 to 8 samples a pixel's side", [&] { draw(9, {.samples = 9}); }},
      {"the largest jump must be above 0", [&] { draw(9, {.largest_jump = 0}); }},
  });
}

TEST(RenderMessages, ASheetWithoutRoomSaysSo) {
  SheetContent content;
  content.extent = {0, 0, 100, 100};
  SheetOptions options;
  options.size = {30, 40};
  SheetReport report;
  expect_refused<UsageError>({
      {"a sheet of 30 x 40 mm has no room for a map and its margin: take a larger one",
       [&] { contour_sheet(content, options, false, report); }},
  });
}

TEST(RenderMessages, WhatTheDrawingLibraryRefusesIsSaid) {
  CurvePicture picture;
  picture.panels.resize(1);
  picture.panels[0].labels.push_back({{0.5, 0.5}, "\xff", {}});  // no text in UTF-8
  const ScratchFolder scratch;
  const std::string file = (scratch.path() / "o.pdf").string();
  expect_refused<CannotWrite>({{"cannot draw: input string not valid UTF-8", [&] { write_picture(picture, file); }}});
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace retalho::test
