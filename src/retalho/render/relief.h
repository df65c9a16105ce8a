// Shaded relief: a surface seen from straight above, lit from one side, coloured by height or by error. Every sample is
// lit with the surface's true normal, and a pixel is the mean of its samples.
#pragma once

#include "retalho/render/color.h"
#include "retalho/render/field.h"
#include "retalho/render/image.h"

namespace retalho {

struct ReliefOptions {
  double azimuth = 315;     ///< where the light comes from, degrees clockwise from north
  double altitude = 45;     ///< its height over the horizon, degrees, above 0 and at most 90
  double exaggeration = 1;  ///< heights are multiplied by this before they are lit
  ColorRamp ramp = ColorRamp::hypsometric;
  double low = 0, high = 1;  ///< the values of the ramp's ends
  int samples = 3;           ///< a side of a pixel
};

/// Brightness in [0, 1] of a surface with this gradient: some light from everywhere, the rest by the cosine between the
/// normal and the light. Flat ground has about 0.8 at any altitude of the light.
double shade(Vec2 gradient, const ReliefOptions& options);

/// `window`'s points are pixel centres. Where there is no data the picture is white. `color` gives the values that the
/// ramp colours; empty: the heights themselves.
Image shade_relief(const FieldSource& surface, const Window& window, const ReliefOptions& options,
                   const FieldSource& color = {}, const Context& context = {});

/// A vertical exaggeration for which the relief reads well: the root mean square slope of the window becomes 0.5;
/// rounded to two digits. 1 for a flat surface.
double good_exaggeration(const FieldSource& surface, const Window& window, const Context& context = {});

/// Least and largest height in the window; {0, 1} when it holds no data.
struct Range {
  double low = 0, high = 1;
};
Range height_range(const FieldSource& surface, const Window& window, const Context& context = {});

}  // namespace retalho
