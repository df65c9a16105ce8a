// Breaklines: lines of a survey that the surface may fold along (ridges, ditches, walls, shores). Triangles keep to
// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"
#include "retalho/tin/scattered.h"
#include "retalho/tin/tin.h"

namespace retalho {

struct BreaklineNotes {
  std::size_t lines = 0;            ///< with at least two different places
  std::size_t crossings = 0;        ///< where two lines cross; a vertex was put there
  double largest_disagreement = 0;  ///< between the heights of two lines where they cross; the mean was taken
  std::size_t draped = 0;           ///< vertices without a height, put on the flat surface of the points
};

struct ConstrainedTin {
  Tin tin;
  std::vector<std::uint32_t> edges;  ///< on a breakline: numbers of build_edges(tin), ascending
};

/// Does a segment run from its lesser end (in the order of x, then y)? Places on it are counted from there, so that a
/// line and the same line backwards get the same ones, to the last bit.
inline bool from_lesser_end(Vec2 from, Vec2 to) {
  return from.x < to.x || (from.x == to.x && from.y <= to.y);
}

/// The line with vertices put in, at equal distances, so that no step in plan is longer than `longest` (> 0). A crease
/// fades out over its last edge: a line of few long segments would hardly fold the surface.
std::vector<Vec3> with_steps(std::span<const Vec3> line, double longest);

/// How far apart points are in plan, were they spread evenly over their box; 0 for less than two places.
double mean_spacing(std::span<const Vec3> points);

/// Constrained Delaunay triangulation of points and breaklines: every segment of a breakline is an edge, or a chain of
/// edges where vertices lie on it; all other edges are locally Delaunay (exact predicates). A vertex whose z is NaN
/// gets its height from the flat Delaunay surface of `points`. Where lines cross, a vertex is made at the rounded
/// crossing with the mean of both heights. Vertices and triangles come in the order of triangulate_points. Throws
/// BadInput: as triangulate_points; a breakline's vertex that is not finite in x, y; one without height outside the
/// points; lines that still cross after their crossings were rounded to doubles eight times over. Cost: that of
/// triangulate_points, and a few us a segment.
ConstrainedTin triangulate_points(std::span<const Vec3> points, std::span<const std::vector<Vec3>> breaklines,
                                  ScatteredNotes* notes = nullptr, BreaklineNotes* breakline_notes = nullptr,
                                  const Context& context = {});

}  // namespace retalho
