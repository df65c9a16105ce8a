// The work of `retalho curve`: what was asked for, and the steps from a file to files and to a report.
#pragma once

#include <optional>

#include "program.h"
#include "retalho/curve/document.h"
#include "retalho/curve/explicit.h"
#include "retalho/level/implicit_curve.h"
#include "retalho/render/curve_sheet.h"

namespace retalho::app {

struct CurveWork : CurveSheetOptions {
  std::string convert;
  int degree = 0;
  bool reverse = false, crossings = false;
  std::vector<double> cut, closest, at;
  int depth = 9;
};

/// A curve of the file, in whatever form it can be had.
struct NamedCurve {
  CurveSpec spec;
  std::string where;                   ///< "curves[2]"
  std::optional<Curve> curve;          ///< the hub form, where there is an exact one
  std::optional<ExplicitCurve> graph;  ///< a formula in x that is no polynomial
  std::optional<ImplicitCurve> level;  ///< a formula in x and y
  double reduction_error = -1;         ///< of --degree
};

std::vector<NamedCurve> load_curves(const std::string& file, const CurveWork& work, const Program& program);
void write_curves(const std::vector<NamedCurve>& curves, const std::string& path, const CurveWork& work, bool overwrite,
                  const Context& context);
nlohmann::ordered_json report_curves(const std::vector<NamedCurve>& curves, const CurveWork& work,
                                     const Context& context);
std::string report_text(const nlohmann::ordered_json& report);

}  // namespace retalho::app
