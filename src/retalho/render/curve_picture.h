// A drawing of plane curves as a list of what is to be seen, in the curves' own coordinates, and its three files: SVG
// (whose paths carry the curves' exact numbers), PDF and PNG. Cairo stands behind this header and nowhere else.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "retalho/curve/plane_path.h"
#include "retalho/render/image.h"

namespace retalho {

struct Stroke {
  Rgb color{20, 60, 120};
  double width = 1.6;  ///< pixels
  bool dashed = false;
  bool filled = false;  ///< filled instead of stroked
};

/// One thing to draw. Sizes are in pixels, positions in the panel's coordinates.
struct PicturePath {
  PlanePath path;
  Stroke stroke;
  bool decoration = false;
};  ///< decorations are not read back
struct PictureDot {
  Vec2 at;
  double radius = 3;
  Rgb color;
  bool hollow = false;
};
struct PictureBox {
  Vec2 low, high;
  Rgb color;
};  ///< filled; at least a pixel wide
struct PictureLabel {
  Vec2 at;
  std::string text;
  Rgb color;
};

struct PicturePanel {
  std::string title;           ///< above the frame
  std::string caption;         ///< beneath it
  Vec2 low{0, 0}, high{1, 1};  ///< what is shown
  bool axes = false;           ///< a frame with numbers
  bool stretch = false;        ///< x and y have scales of their own (graphs of functions)
  std::vector<PictureBox> boxes;
  std::vector<PicturePath> paths;
  std::vector<PictureDot> dots;
  std::vector<PictureLabel> labels;
};

/// Panels stand side by side, in rows of `columns` (0: all in one row).
struct CurvePicture {
  std::vector<PicturePanel> panels;
  int columns = 0;
  int panel_width = 640, panel_height = 480;
};

/// By the ending: .svg, .pdf or .png. Atomic. Throws UsageError (another ending), BadInput (nothing to draw),
/// CannotWrite.
void write_picture(const CurvePicture& picture, const std::string& path, bool overwrite = false);

/// Makes the panel show everything that is in it, with a margin of 6 %.
void fit_panel(PicturePanel& panel);

/// The SVG text, for tests and pages.
std::string to_svg(const CurvePicture& picture);

}  // namespace retalho
