// Heights and gradients on a regular window: what a picture is shaded from, whatever the surface.
#pragma once

#include <functional>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/bicubic.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/tiles/reader.h"

namespace retalho {

/// Points (column, row) at origin + (column * step.x, -row * step.y), in the local coordinates of `georef`.
struct Window {
  Georef georef;
  Vec2 origin, step{1, 1};
  int columns = 0, rows = 0;

  Vec2 at(double column, double row) const { return {origin.x + column * step.x, origin.y - row * step.y}; }
};

/// A box in local coordinates.
struct Extent {
  Vec2 low, high;
  double width() const { return high.x - low.x; }
  double height() const { return high.y - low.y; }
};

struct HeightField {
  std::vector<double> heights;  ///< row-major; NaN: no data
  std::vector<Vec2> gradients;  ///< one a height; meaningless where there is no data
};

/// Anything that can fill a window. The same window gives the same field from any number of threads.
using FieldSource = std::function<HeightField(const Window&, const Context&)>;

/// The model's heights and true gradients. Refers to the evaluator.
FieldSource field_of(const TerrainEvaluator& evaluator);
/// The same of a tiled model, as from the joined one but for rounding; each tile is read once a window. Refers to the
/// reader.
FieldSource field_of(TileReader& reader);
/// A grid as it is: bilinear between cell centres, gradients by central differences at them; no data where the nearest
/// cell is void or beyond half a cell outside. Refers to the raster.
FieldSource field_of(const Raster& raster);
/// The first's heights less the second's (no gradients); no data where either has none.
FieldSource difference_of(FieldSource first, FieldSource second);

/// The box of the cell centres, or of the vertices.
Extent extent_of(const Raster& raster);
Extent extent_of(const Terrain& terrain);
Extent extent_of(const BicubicGrid& grid);
/// `extent` of one local system in another's.
Extent moved(const Extent& extent, const Georef& from, const Georef& to);

/// The window of columns x rows square pixels that holds `extent`, centred, pixel centres as points.
Window fit_window(const Georef& georef, const Extent& extent, int columns, int rows);

/// Every point of a pixel `window` `factor` times a side: the finer window's points lie evenly in each pixel.
Window refined(const Window& window, int factor);

}  // namespace retalho
