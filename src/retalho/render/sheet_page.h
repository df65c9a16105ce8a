// Internal to render/: what stands on a map sheet, in millimetres from the page's top left corner, y down. The SVG and
// the PDF writer draw the same page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retalho/curve/plane_path.h"
#include "retalho/render/image.h"

namespace retalho {

/// Words whose middle line passes through `at`.
struct PageText {
  Vec2 at;
  std::string text;
  double size = 2.5;    ///< height of the em
  double angle = 0;     ///< clockwise, degrees
  double anchor = 0.5;  ///< which part of the width lies before `at`: 0 starts there, 1 ends there
  Rgb color;
  double halo = 0;  ///< width of the paper's colour around the letters; 0: none
};

struct PagePath {
  PlanePath path;
  std::string note;  ///< an attribute of SVG, data-elev="..."; empty: none
};

/// Paths of one look, then words.
struct PageGroup {
  std::string name;
  std::optional<Rgb> fill, stroke;
  double width = 0.1;       ///< of the stroke
  bool clipped = false;     ///< to the map's frame
  bool decoration = false;  ///< not the map's own lines: read_svg leaves it out
  std::vector<PagePath> paths;
  std::vector<PageText> texts;
};

struct SheetPage {
  double width = 297, height = 210;
  Vec2 frame_low, frame_high;  ///< top left and bottom right corner of the map
  std::string title;           ///< of the document
  std::vector<PageGroup> groups;
};

/// Coordinates as shortest decimals: what is a short decimal in the page is one in the file.
std::string page_svg(const SheetPage& page);

/// Paths to 2^-16 point (5e-6 mm). The same page gives the same bytes. Throws CannotWrite when cairo fails.
std::string page_pdf(const SheetPage& page);

}  // namespace retalho
