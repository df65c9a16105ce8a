// Where a panel's coordinates come to lie on the page; shared by the SVG and the Cairo writer.
#pragma once

#include <vector>

#include "retalho/render/curve_picture.h"

namespace retalho {

/// page = (left + sx * x, top + sy * y): sy is negative, y points up.
struct PanelLayout {
  double frame_left = 0, frame_top = 0, frame_width = 0, frame_height = 0;
  double left = 0, top = 0, sx = 1, sy = -1;
  Vec2 place(Vec2 p) const { return {left + sx * p.x, top + sy * p.y}; }
};

/// Pixels of the whole picture.
int picture_width(const CurvePicture& picture);
int picture_height(const CurvePicture& picture);

PanelLayout layout_panel(const CurvePicture& picture, std::size_t index);

/// Round numbers (1, 2, 5 times a power of ten) between low and high, about `count` of them.
std::vector<double> ticks(double low, double high, int count);

}  // namespace retalho
