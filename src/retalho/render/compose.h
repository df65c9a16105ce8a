// Several pictures on one sheet: equal panels in rows, a caption under each.
#pragma once

#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/render/image.h"

namespace retalho {

/// Where the panels of a sheet lie. Every panel is `width` x `height`, its caption's lines are below it.
struct Layout {
  int sheet_width = 0, sheet_height = 0;
  int columns = 1, rows = 1;
  int width = 0, height = 0;  ///< of a panel's picture
  int gap = 0, caption = 0;   ///< pixels between panels, and under each for its caption

  int left(int panel) const { return gap + panel % columns * (width + gap); }
  int top(int panel) const { return gap + panel / columns * (height + caption + gap); }
};

/// The layout of `panels` pictures on a sheet of this size that gives pictures of `aspect` (width / height) the most
/// room. `caption_lines` of the caption's font are kept under each. Throws UsageError when the sheet is too small.
Layout fit_layout(int panels, int sheet_width, int sheet_height, double aspect, int caption_lines);

/// A layout whose pictures are `width` x `height`, all in one row up to four, else in two or more rows.
Layout grow_layout(int panels, int width, int height, int caption_lines);

/// Pixels of the caption's font.
inline constexpr double kCaptionPixels = 13;

struct Panel {
  Image picture;
  std::vector<std::string> caption;  ///< one string a line; too long ones are shortened in the middle
};

/// Each panel's picture is let go when it is on the sheet. Throws CannotRead when captions are asked for and the font
/// is missing.
Image compose(const Layout& layout, std::vector<Panel> panels, const Context& context = {});

}  // namespace retalho
