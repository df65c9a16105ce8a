// Colour ramps that people with any colour vision can read, and the blend of a colour with light.
#pragma once

#include "retalho/render/image.h"

namespace retalho {

enum class ColorRamp {
  hypsometric,  ///< low to high: dark blue-green, olive, sand, pale rose; lightness rises all the way
  gray,         ///< one light gray: the shading alone speaks
  diverging,    ///< below to above: blue, white, red; for errors
};

/// Colour as three numbers in [0, 1], so that shades can be averaged before they are rounded.
struct Color {
  double r = 0, g = 0, b = 0;
};
constexpr Color operator+(Color a, Color b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
constexpr Color operator*(double s, Color a) {
  return {s * a.r, s * a.g, s * a.b};
}

/// The ramp at `t`; outside of [0, 1] (and for NaN) its ends are taken (its start).
Color ramp_color(ColorRamp ramp, double t);

Rgb to_rgb(Color color);

}  // namespace retalho
