#include "retalho/tin/predicates.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#pragma GCC diagnostic pop

namespace retalho {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_2 point(Vec2 p) {
  return {p.x, p.y};
}

}  // namespace

int orientation_exact(Vec2 a, Vec2 b, Vec2 c) {
  return static_cast<int>(CGAL::orientation(point(a), point(b), point(c)));
}

int in_circle_exact(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  return static_cast<int>(CGAL::side_of_oriented_circle(point(a), point(b), point(c), point(d)));
}

}  // namespace retalho
