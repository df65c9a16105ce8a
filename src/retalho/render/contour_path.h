// A contour line in the drawing form of plane curves.
#pragma once

#include "retalho/curve/plane_path.h"
#include "retalho/level/contours.h"

namespace retalho {

/// The line's points in its own coordinates, closed where the line is.
inline PlanePath contour_path(const ContourSet& set, const ContourLine& line) {
  PlanePath path;
  for (std::size_t i = line.begin; i < line.end; ++i) {
    path.verbs.push_back(i == line.begin ? PathVerb::move : PathVerb::line);
    path.points.push_back(set.points[i]);
  }
  if (line.closed) path.verbs.push_back(PathVerb::close);
  return path;
}

}  // namespace retalho
