#include "retalho/render/compose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/render/text.h"

namespace retalho {
namespace {

constexpr int kGap = 10;
constexpr int kLinePixels = 17;  // of the caption
constexpr int kLeast = 8;        // side of a panel's picture

int caption_pixels(int lines) {
  return lines > 0 ? lines * kLinePixels + 4 : 0;
}

}  // namespace

Layout fit_layout(int panels, int sheet_width, int sheet_height, double aspect, int caption_lines) {
  const int caption = caption_pixels(caption_lines);
  Layout best;
  double most = -1;
  for (int columns = 1; columns <= panels; ++columns) {
    const int rows = (panels + columns - 1) / columns;
    const int width = (sheet_width - kGap) / columns - kGap, height = (sheet_height - kGap) / rows - kGap - caption;
    if (width < kLeast || height < kLeast) continue;
    const double used = std::min(static_cast<double>(width), height * aspect);  // width of the picture inside
    if (used <= most) continue;
    most = used;
    best = {sheet_width, sheet_height, columns, rows, width, height, kGap, caption};
  }
  if (most < 0)
    throw UsageError(
        fmt::format("{} pictures do not fit on {} x {} pixels: give a larger size", panels, sheet_width, sheet_height));
  return best;
}

Layout grow_layout(int panels, int width, int height, int caption_lines) {
  const int caption = caption_pixels(caption_lines);
  const int columns = panels <= 4 ? panels : static_cast<int>(std::ceil(std::sqrt(panels)));
  const int rows = (panels + columns - 1) / columns;
  return {columns * (width + kGap) + kGap,
          rows * (height + caption + kGap) + kGap,
          columns,
          rows,
          width,
          height,
          kGap,
          caption};
}

Image compose(const Layout& layout, std::vector<Panel> panels, const Context& context) {
  Image sheet(layout.sheet_width, layout.sheet_height);
  for (int k = 0; k < static_cast<int>(panels.size()); ++k) {
    const Image picture = std::move(panels[static_cast<std::size_t>(k)].picture);  // gone when it is on the sheet
    for (int y = 0; y < std::min(picture.height, layout.height); ++y) {
      context.check();
      for (int x = 0; x < std::min(picture.width, layout.width); ++x)
        sheet.at(layout.left(k) + x, layout.top(k) + y) = picture.at(x, y);
    }
  }
  if (layout.caption == 0) return sheet;
  const Font font(kCaptionPixels);
  for (int k = 0; k < static_cast<int>(panels.size()); ++k) {
    int baseline = layout.top(k) + layout.height + font.ascent() + 2;
    for (const std::string& line : panels[static_cast<std::size_t>(k)].caption) {
      const std::string words = font.shortened(line, layout.width);
      font.draw(sheet, layout.left(k) + (layout.width - font.width(words)) / 2, baseline, words);
      baseline += kLinePixels;
    }
  }
  return sheet;
}

}  // namespace retalho
