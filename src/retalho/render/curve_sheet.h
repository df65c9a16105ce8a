// A whole picture of curves: the curves themselves, and what is asked for to explain them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/curve/explicit.h"
#include "retalho/level/implicit_curve.h"
#include "retalho/render/curve_drawing.h"
#include "retalho/render/curve_picture.h"

namespace retalho {

/// One curve, in whatever form it can be had: one of the three pointers.
struct SheetCurve {
  const Curve* curve = nullptr;
  const ExplicitCurve* graph = nullptr;
  const ImplicitCurve* level = nullptr;
  std::vector<Vec3> given = {};  ///< the points that it was made from, where they are to be drawn
  int dimension = 2;             ///< of those points
  std::vector<double> box = {};  ///< of a level set: xmin, ymin, xmax, ymax
};

struct CurveSheetOptions {
  double flatten = 0;  ///< over 0: drawn as the straight segments of curve/flatten.h to this tolerance
  bool control = false, tangents = false, comb = false, hodograph = false, joins = false, points = false, axes = false,
       stretch = false;
  double comb_scale = 0;            ///< as draw_comb has it
  std::optional<double> casteljau;  ///< de Casteljau's construction at this parameter
  std::vector<double> window;       ///< xmin, ymin, xmax, ymax; empty: everything
  std::string title;
  CurveView view = CurveView::iso;  ///< of curves in space
  int width = 640, height = 480;    ///< pixels of a panel
};

/// One panel with all curves and, with `hodograph`, one more for each parametric curve. Throws UsageError for a window
/// that is empty.
CurvePicture curve_sheet(const std::vector<SheetCurve>& curves, const CurveSheetOptions& options = {},
                         const Context& context = {});

}  // namespace retalho
