// Internal to render/: what stands around a map: frame, coordinates, scale bar, legend of tints.
#pragma once

#include <string>
#include <vector>

#include "retalho/raster/georef.h"
#include "retalho/render/field.h"
#include "retalho/render/sheet_labels.h"
#include "retalho/render/sheet_page.h"

namespace retalho {

/// From local coordinates to the page.
struct SheetMap {
  Vec2 low, high;       ///< the frame's top left and bottom right corner on the page
  Vec2 origin;          ///< local coordinates of the top left corner
  double scale = 1;     ///< mm a local unit
  double per_unit = 0;  ///< page coordinates are rounded to multiples of 1 / per_unit; 0: not at all

  Vec2 exact(Vec2 local) const { return {low.x + (local.x - origin.x) * scale, low.y + (origin.y - local.y) * scale}; }
  Vec2 place(Vec2 local) const;
};

/// "412000", or degrees as 84°15′E.
std::string coordinate_words(double value, double step, bool geographic, bool east);
/// Round numbers from `low` to `high` (of degrees, minutes or seconds where geographic) at most `most` steps apart.
std::vector<double> coordinate_ticks(double low, double high, double most, bool geographic, double& step);

/// The frame with its ticks and their coordinates in the CRS.
PageGroup draw_frame(const SheetMap& map, const Georef& georef, const TextWidth& width);

/// A bar of a round length, at most `room` mm, its left end at `at`.
PageGroup draw_scale_bar(const SheetMap& map, const std::string& unit, Vec2 at, double room);

/// 1 : N where the unit is known; empty otherwise.
std::string scale_words(const SheetMap& map, const std::string& unit);

struct TintStep {
  Rgb color;
  std::string above;  ///< height of its upper border; empty: none
};
/// Boxes in a row, `room` mm at most, their borders' heights beneath (as many as have room).
std::vector<PageGroup> draw_tint_legend(const std::vector<TintStep>& steps, Vec2 at, double room,
                                        const TextWidth& width);

/// Horizontal and vertical strokes, and boxes.
PlanePath line_path(Vec2 a, Vec2 b);
PlanePath box_path(Vec2 low, Vec2 high);

}  // namespace retalho
