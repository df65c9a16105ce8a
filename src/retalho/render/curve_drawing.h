// From curves to the things of a picture: the curve itself, and what explains it.
#pragma once

#include <optional>
#include <string>

#include "retalho/curve/explicit.h"
#include "retalho/level/implicit_curve.h"
#include "retalho/render/curve_picture.h"

namespace retalho {

/// Curves in space are seen from a side: an affine map, so their control points stay control points.
enum class CurveView { iso, top, front, side };
Curve project(const Curve& curve, CurveView view);

/// The n-th colour of a set that the colour-blind can tell apart (Okabe and Ito).
Rgb curve_color(std::size_t n);

void draw_curve(PicturePanel& panel, const Curve& plane, const Stroke& stroke);
/// Segment by segment: the control points and the lines between them.
void draw_control_polygon(PicturePanel& panel, const Curve& plane, Rgb color);
/// Arrows along Q' at joins and ends, `scale` times the derivative.
void draw_tangents(PicturePanel& panel, const Curve& plane, double scale, Rgb color);
/// Teeth of length `scale` times the curvature, away from the centre of curvature; a comb for each segment, so that it
/// breaks where the curvature jumps. `scale` 0: the longest tooth is a fifth of the curve's size.
void draw_comb(PicturePanel& panel, const Curve& plane, double scale, Rgb color);
/// All lines of de Casteljau's construction at the curve's parameter u.
void draw_casteljau(PicturePanel& panel, const Curve& plane, double u);
/// Joins as dots: regular ones filled, others hollow.
void draw_joins(PicturePanel& panel, const Curve& plane, Rgb color);
void draw_explicit(PicturePanel& panel, const ExplicitCurve& curve, const Stroke& stroke);
/// Lines as lines, cells without a certificate as cells, doubtful cells pale.
void draw_implicit(PicturePanel& panel, const ImplicitCurve& curve, const Stroke& stroke);

/// The hodograph Q' in a panel of its own, with the origin.
PicturePanel hodograph_panel(const Curve& plane, Rgb color);

}  // namespace retalho
