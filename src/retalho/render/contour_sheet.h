// Contour lines as a finished map sheet, SVG or PDF (docs/contours.md, "Map sheets"): lines by class, index contours
// thicker and labelled along the line with uphill up, spot heights, tints between the levels, a frame with coordinates
// of the CRS, a scale bar, a title.
//
// Promises: the paths of both files hold the same numbers (SVG exactly as short decimals, PDF to 5e-6 mm); labels
// overlap neither each other nor the frame; with `curves`, lines are cubic Béziers with the promises of
// level/line_curves.h; the same bytes from any number of threads. Where the map is small against its lines, labels are
// left out, never squeezed.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/contours.h"
#include "retalho/level/spot_heights.h"
#include "retalho/level/write_vector.h"
#include "retalho/raster/georef.h"
#include "retalho/render/field.h"

namespace retalho {

/// What is drawn. All in the local coordinates of `georef`.
struct SheetContent {
  const ContourSet* lines = nullptr;
  const BandSet* bands = nullptr;  ///< null: no tints
  std::vector<SpotHeight> spots;   ///< the most important first
  std::vector<bool> index;         ///< one a level: is it an index contour?
  Georef georef;
  Extent extent;             ///< what the frame holds
  double low = 0, high = 0;  ///< of the heights, for words
  std::string height_unit;   ///< empty: not known
};

struct SheetOptions {
  Vec2 size;  ///< mm; see sheet_size
  std::string title;
  std::string crs_name;
  std::string levels;  ///< words in the margin: "Contour lines every 20"
  /// Cubic Béziers no farther than `tolerance` (local units, > 0) from the level lines; `lines` then hold the traced
  /// vertices, within `traced` (< tolerance) of them. Otherwise polylines.
  bool curves = false;
  double tolerance = 0, traced = 0;
};

struct SheetReport {
  double scale = 0;                       ///< mm a local unit
  std::size_t labels = 0, spots = 0;      ///< drawn
  std::size_t curves = 0, straight = 0;   ///< pieces: cubics; those that fell back to the traced line
  std::size_t corners = 0, unproved = 0;  ///< as in CurveSet
};

/// "A0" to "A6" (the longer side along the longer side of the map, whose width / height is `aspect`), or "WxH" in mm,
/// 80 to 5000 each. Throws UsageError.
Vec2 sheet_size(std::string_view name, double aspect);

/// "Contour lines every 20 m; every 5th is an index contour".
std::string level_words(const std::vector<double>& levels, const std::string& height_unit, const VectorOptions& lines);
/// SheetContent::index of these levels.
std::vector<bool> index_levels(const std::vector<double>& levels, const VectorOptions& lines);

/// The bytes of the file. Throws UsageError for a sheet without room for a map, BadInput for a map without extent,
/// CannotRead where the font is missing.
std::string contour_sheet(const SheetContent& content, const SheetOptions& options, bool pdf, SheetReport& report,
                          const Context& context = {});

}  // namespace retalho
