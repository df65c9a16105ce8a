// Pictures of TetraQuad surfaces by ray casting: every pixel's hit is a root of the surface's own cubic, lit by its
// exact normal. No triangles are made.
#pragma once

#include <string>
#include <vector>

#include "retalho/raster/georef.h"
#include "retalho/render/image.h"
#include "retalho/tetraquad/rays.h"

namespace retalho {

/// What lies beyond the plane, where dot(normal, p) > offset, is cut away.
struct CutPlane {
  Vec3 normal;
  double offset = 0;
};

/// "x<0.5" or "z>3": what is kept, in the coordinates of the CRS. Throws UsageError.
CutPlane parse_cut(const std::string& text, const Georef& georef = {});

enum class TetraQuadColors {
  plain,         ///< stone outside, copper inside
  normal_jumps,  ///< how far normals jump at the nearest face: white 0 to red `largest_jump` degrees
};

struct TetraQuadPictureOptions {
  char up = 'z';              ///< the axis that points up: x, y or z
  double from = 200;          ///< where the eye stands, degrees clockwise from the next axis but one, seen from above
  double elevation = 20;      ///< of the eye over the horizon, degrees, -90 to 90
  double field_of_view = 30;  ///< degrees, 1 to 120
  std::vector<CutPlane> cuts = {};
  bool outlines = false;  ///< draws where tetrahedra meet on the surface
  TetraQuadColors colors = TetraQuadColors::plain;
  double largest_jump = 10;  ///< degrees, the end of the ramp
  int samples = 2;           ///< rays a pixel's side, 1 to 8
};

/// How far the normals of the two sides are apart, in degrees, across the face that is nearest to the place; 0 on the
/// border. `faces` are the surface's own.
double normal_jump(const TetraQuadField& field, const HalfFaces& faces, std::size_t tet, const TetBarycentric& b);

/// A width x height picture that the whole surface fits into, on white. Throws UsageError for options out of range,
/// BadInput for a surface that touches no tetrahedron.
Image draw_tetraquad(const TetraQuadField& field, const TetraQuadRays& rays, int width, int height,
                     const TetraQuadPictureOptions& options = {}, const Context& context = {});

}  // namespace retalho
