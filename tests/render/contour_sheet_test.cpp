// The promises of render/contour_sheet.h.
#include "retalho/render/contour_sheet.h"

#include <cpl_conv.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <sstream>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/curve/plane_path.h"
#include "retalho/level/contour.h"
#include "retalho/render/sheet_frame.h"
#include "retalho/render/sheet_labels.h"
#include "support/support.h"

namespace retalho {
namespace {

double height_at(double x, double y) {
  return 100 + 60 * std::sin(x * 0.017) * std::cos(y * 0.013) + 40 * std::sin(x * 0.005 - y * 0.007);
}

/// Hills, their lines and bands, ready for a sheet.
struct Hills {
  BicubicGrid grid;
  ContourSet lines;
  ContourExtras extras;
  SheetContent content;
  SheetOptions options;

  explicit Hills(bool curves, std::vector<double> levels = contour_levels(-50, 250, 10)) {
    Raster raster;
    raster.columns = 70;
    raster.rows = 50;
    raster.cell_width = raster.cell_height = 10;
    std::vector<double> z;
    for (int r = 0; r < raster.rows; ++r)
      for (int c = 0; c < raster.columns; ++c) z.push_back(height_at(10 * c, -10 * r));
    raster.heights = z;
    grid = make_bicubic(raster);
    extras.want_bands = true;
    lines = trace_contours(grid, levels, {curves ? 0.2 : 1.0, !curves}, {}, &extras);
    content.lines = &lines;
    content.bands = &extras.bands;
    content.spots = find_spot_heights(grid, 10);
    for (const double level : levels) content.index.push_back(std::fmod(level, 50) == 0);
    content.georef.origin_x = 412000;
    content.georef.origin_y = 5432100;
    content.georef.unit = "metre";
    content.extent = extent_of(grid);
    content.low = 5;
    content.high = 195;
    options.size = sheet_size("A4", 1.4);
    options.title = "Hills & <valleys>";
    options.levels = "Contour lines every 10";
    options.curves = curves;
    options.tolerance = 1;
    options.traced = curves ? 0.2 : 0;
  }
};

/// The map's own lines, read back from the SVG text.
std::vector<Curve> read_back(const std::string& svg) {
  const test::ScratchFolder folder;
  return read_svg(folder.put("map.svg", svg));
}

TEST(ContourSheet, TheSvgHoldsEveryLineWhereItIs) {
  const Hills hills(false);
  SheetReport report;
  const std::string svg = contour_sheet(hills.content, hills.options, false, report);
  const std::vector<Curve> curves = read_back(svg);
  ASSERT_EQ(curves.size(), hills.lines.lines.size());
  std::size_t points = 0;
  for (const Curve& curve : curves) points += curve.segment_count();
  std::size_t sides = 0;
  for (const ContourLine& line : hills.lines.lines) sides += line.end - line.begin - (line.closed ? 0 : 1);
  EXPECT_EQ(points, sides);
  EXPECT_NE(svg.find("width=\"297mm\" height=\"210mm\""), std::string::npos);
  EXPECT_NE(svg.find("Hills &amp; &lt;valleys&gt;"), std::string::npos);
  EXPECT_NE(svg.find("data-elev=\"150\""), std::string::npos);
  EXPECT_NE(svg.find("id=\"tint-"), std::string::npos);
  EXPECT_NE(svg.find(">412200<"), std::string::npos);  // a coordinate of the frame
  EXPECT_NE(svg.find("about 1 : "), std::string::npos);
  EXPECT_GT(report.labels, 5U);
  EXPECT_GT(report.spots, 3U);
  EXPECT_EQ(report.curves, 0U);
}

TEST(ContourSheet, CurvesAreCubicsWithinTheToleranceOfTheLevel) {
  const Hills hills(true);
  SheetReport report;
  const std::string svg = contour_sheet(hills.content, hills.options, false, report);
  EXPECT_GT(report.curves, 50U);
  EXPECT_EQ(report.unproved, 0U);
  const std::vector<Curve> curves = read_back(svg);
  ASSERT_EQ(curves.size(), hills.lines.lines.size());
  std::size_t cubics = 0;
  for (const Curve& curve : curves) cubics += curve.segment_count();
  // Back to the ground by what the frame's box says; index contours come last in the file.
  double number[4] = {0, 0, 0, 0};
  const std::size_t box = svg.find("<clipPath id=\"frame\"><rect x=");
  ASSERT_EQ(
      std::sscanf(svg.c_str() + box, "<clipPath id=\"frame\"><rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"",
                  &number[0], &number[1], &number[2], &number[3]),
      4);
  std::vector<double> levels;
  for (const bool index : {false, true})
    for (const ContourLine& line : hills.lines.lines)
      if (hills.content.index[static_cast<std::size_t>(line.level)] == index)
        levels.push_back(hills.lines.levels[static_cast<std::size_t>(line.level)]);
  for (std::size_t k = 0; k < curves.size(); ++k)
    for (int i = 0; i <= 200; ++i) {
      const Vec3 p = evaluate(curves[k], curves[k].begin() + (curves[k].end() - curves[k].begin()) * i / 200);
      const Vec2 local{(p.x - number[0]) / report.scale, -(p.y - number[1]) / report.scale};
      const std::optional<Jet> jet = hills.grid.at({std::clamp(local.x, 0.0, hills.content.extent.high.x),
                                                    std::clamp(local.y, hills.content.extent.low.y, 0.0)});
      ASSERT_TRUE(jet);
      // A point a tolerance away is no farther in height than the slope there and its change allow.
      const double bend = std::abs(jet->xx) + std::abs(jet->yy) + 2 * std::abs(jet->xy);
      EXPECT_LE(std::abs(jet->value - levels[k]), norm(jet->gradient) + 2 * bend + 1e-3);
    }
  EXPECT_EQ(cubics, report.curves + report.straight);
  EXPECT_LT(5 * cubics, hills.lines.points.size());
}

/// Control points of all cubics that a PDF strokes and does not fill, in mm.
std::vector<Vec2> stroked_cubics(const std::string& pdf) {
  std::vector<Vec2> points;
  for (std::size_t at = pdf.find("\nstream\n"); at != std::string::npos; at = pdf.find("\nstream\n", at + 1)) {
    const std::size_t begin = at + 8, end = pdf.find("endstream", begin);
    if (end == std::string::npos) break;
    std::size_t size = 0;
    void* bytes = CPLZLibInflate(pdf.data() + begin, end - begin, nullptr, 0, &size);
    if (bytes == nullptr) continue;
    std::istringstream text(std::string(static_cast<const char*>(bytes), size));
    CPLFree(bytes);
    std::vector<double> numbers;
    bool first = true, glyphs = false;
    for (std::string word; text >> word;) {
      // The page itself turns y up and draws halos of letters; the maps' lines are in streams of their own.
      if (first) glyphs = word != "q";
      first = false;
      if (glyphs) break;
      char* rest = nullptr;
      const double number = std::strtod(word.c_str(), &rest);
      if (*rest == '\0') {
        numbers.push_back(number);
        continue;
      }
      if (word == "c" && numbers.size() >= 6)
        for (std::size_t k = numbers.size() - 6; k < numbers.size(); k += 2)
          points.push_back({numbers[k] / 256 * 25.4 / 72, numbers[k + 1] / 256 * 25.4 / 72});
      numbers.clear();
    }
  }
  return points;
}

TEST(ContourSheet, ThePdfHasTheSameCurves) {
  Hills hills(true);
  SheetReport report;
  const std::string pdf = contour_sheet(hills.content, hills.options, true, report);
  ASSERT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_NE(pdf.find("%%EOF"), std::string::npos);
  std::vector<Vec2> expected;
  for (const Curve& curve : read_back(contour_sheet(hills.content, hills.options, false, report)))
    for (std::size_t i = 0; i < curve.segment_count(); ++i)
      if (curve.first[i + 1] - curve.first[i] == 4)
        for (std::uint32_t k = curve.first[i] + 1; k < curve.first[i + 1]; ++k)
          expected.push_back({curve.points[k].x, curve.points[k].y});
  const std::vector<Vec2> drawn = stroked_cubics(pdf);
  ASSERT_EQ(expected.size(), 3 * report.curves);
  ASSERT_EQ(drawn.size(), expected.size());
  for (std::size_t k = 0; k < drawn.size(); ++k) ASSERT_LT(norm(drawn[k] - expected[k]), 1e-5);
}

TEST(ContourSheet, TheSameBytesFromAnyNumberOfThreads) {
  const Hills hills(true);
  SheetReport report;
  for (const bool pdf : {false, true})
    EXPECT_EQ(contour_sheet(hills.content, hills.options, pdf, report, {.threads = 1}),
              contour_sheet(hills.content, hills.options, pdf, report, {.threads = 4}));
}

TEST(ContourSheet, WithoutLinesAFrameAndAWord) {
  Hills hills(true, {5000});
  SheetReport report;
  const std::string svg = contour_sheet(hills.content, hills.options, false, report);
  EXPECT_NE(svg.find("No contour line"), std::string::npos);
  EXPECT_NE(svg.find("id=\"frame\""), std::string::npos);
  EXPECT_THROW(read_back(svg), BadInput) << "no path is the map's own";
  EXPECT_TRUE(contour_sheet(hills.content, hills.options, true, report).starts_with("%PDF-"));
}

TEST(ContourSheet, RefusesASheetWithoutRoom) {
  Hills hills(false);
  SheetReport report;
  hills.options.size = {40, 40};
  EXPECT_THROW(contour_sheet(hills.content, hills.options, false, report), UsageError);
  hills.options.size = {297, 210};
  hills.content.extent = {{0, 0}, {0, 10}};
  EXPECT_THROW(contour_sheet(hills.content, hills.options, false, report), BadInput);
}

TEST(SheetLabels, RunAlongTheirLinesUphillUpAndOverlapNothing) {
  const Hills hills(false);
  SheetMap map;
  map.low = {10, 10};
  map.scale = 0.35;
  map.high = map.low + map.scale * Vec2{hills.content.extent.width(), hills.content.extent.height()};
  map.origin = {0, 0};
  ContourSet page = hills.lines;
  for (Vec2& p : page.points) p = map.place(p);
  const InkMap ink(map.low, map.high);
  LabelRoom room(map.low, map.high);
  const TextWidth width = measure_text();
  const auto words = [&](int level) {
    return std::to_string(static_cast<int>(page.levels[static_cast<std::size_t>(level)]));
  };
  const std::vector<PageText> labels = place_line_labels(
      page, [&](int level) { return static_cast<bool>(hills.content.index[static_cast<std::size_t>(level)]); }, words,
      2.2, width, ink, room);
  ASSERT_GT(labels.size(), 8U);
  for (const PageText& label : labels) {
    // Back to the ground: the height there is the label's, and what is up in the text is uphill.
    const Vec2 local{(label.at.x - map.low.x) / map.scale, -(label.at.y - map.low.y) / map.scale};
    EXPECT_NEAR(height_at(local.x, local.y), std::stod(label.text), 2.5);
    const double turn = label.angle * std::numbers::pi / 180;
    const Vec2 up{std::sin(turn), std::cos(turn)};  // y up again
    const double above = height_at(local.x + 8 * up.x, local.y + 8 * up.y);
    const double below = height_at(local.x - 8 * up.x, local.y - 8 * up.y);
    EXPECT_GT(above, below);
    EXPECT_EQ(std::fmod(std::stod(label.text), 50), 0);
  }
  const std::vector<LabelBox>& boxes = room.taken();
  ASSERT_EQ(boxes.size(), labels.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t k = i + 1; k < boxes.size(); ++k) EXPECT_FALSE(overlap(boxes[i], boxes[k]));
}

TEST(SheetLabels, BoxesOverlapOrNot) {
  const LabelBox a{{0, 0}, {1, 0}, 5, 1};
  EXPECT_TRUE(overlap(a, {{4, 0.5}, {1, 0}, 5, 1}));
  EXPECT_FALSE(overlap(a, {{0, 2.5}, {1, 0}, 5, 1}));
  const double s = std::sqrt(0.5);
  EXPECT_FALSE(overlap(a, {{5, 4}, {s, s}, 3, 1}));  // their upright boxes do overlap
  EXPECT_TRUE(overlap(a, {{5, 2}, {s, s}, 3, 1}));
  LabelRoom room({-10, -10}, {10, 10});
  EXPECT_TRUE(room.take(a));
  EXPECT_FALSE(room.take(a));
  EXPECT_FALSE(room.take({{8, 5}, {1, 0}, 5, 1}));  // over the frame
}

TEST(SheetFrame, CoordinatesAreRoundAndReadable) {
  double step = 0;
  const std::vector<double> ticks = coordinate_ticks(412345, 418765, 1700, false, step);
  EXPECT_EQ(step, 1000);
  ASSERT_EQ(ticks.size(), 6U);
  EXPECT_EQ(ticks[0], 413000);
  EXPECT_EQ(coordinate_words(413000, 1000, false, true), "413000");
  EXPECT_EQ(coordinate_words(0.25, 0.05, false, true), "0.25");
  EXPECT_EQ(coordinate_words(-84.25, 1 / 60.0, true, true), "84°15′W");
  EXPECT_EQ(coordinate_words(36.5, 1 / 60.0, true, false), "36°30′N");
  EXPECT_EQ(coordinate_words(36 + 59.0 / 60 + 50.0 / 3600, 10 / 3600.0, true, false), "36°59′50″N");
  EXPECT_EQ(coordinate_words(7, 1, true, false), "7°N");
  coordinate_ticks(-84.5, -84.1, 0.06, true, step);
  EXPECT_NEAR(step, 2 / 60.0, 1e-12);  // two minutes, not 0.05 degrees
}

TEST(SheetFrame, TheScaleBarIsRound) {
  SheetMap map;
  map.scale = 0.0081;  // mm a metre
  const PageGroup bar = draw_scale_bar(map, "metre", {0, 0}, 60);
  EXPECT_EQ(bar.texts[2].text, "5");
  EXPECT_EQ(bar.texts[3].text, "km");
  EXPECT_NEAR(bar.texts[2].at.x, 5000 * map.scale, 1e-9);
  EXPECT_EQ(draw_scale_bar(map, "US survey foot", {0, 0}, 60).texts[3].text, "ft");
  EXPECT_EQ(scale_words(map, "metre"), "about 1 : 123,000");
  EXPECT_EQ(scale_words(map, "unit"), "");
}

TEST(SheetSize, NamesAndMillimetres) {
  EXPECT_EQ(sheet_size("A4", 2), (Vec2{297, 210}));
  EXPECT_EQ(sheet_size("A4", 0.5), (Vec2{210, 297}));
  EXPECT_EQ(sheet_size("a3", 2), (Vec2{420, 297}));
  EXPECT_EQ(sheet_size("500x400", 1), (Vec2{500, 400}));
  EXPECT_EQ(sheet_size("500x400mm", 1), (Vec2{500, 400}));
  for (const char* bad : {"", "A9", "B4", "A44", "500", "500x", "500x10", "x400", "9000x9000", "500x400cm", "nanxnan"})
    EXPECT_THROW(sheet_size(bad, 1), UsageError) << bad;
}

}  // namespace
}  // namespace retalho
