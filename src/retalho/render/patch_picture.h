// Pictures of triangular parametric patches: shaded, with parameter lines, isophotes, zebra stripes or curvature
// colours.
#pragma once

#include <array>
#include <span>

#include "retalho/core/context.h"
#include "retalho/patch/surface.h"
#include "retalho/render/image.h"

namespace retalho {

enum class PatchStyle {
  shaded,
  lines,      ///< shaded, with lines of equal u, v and w
  isophotes,  ///< bands of equal angle between normal and light: a kink of the surface breaks a band
  zebra,      ///< reflected stripes: a kink breaks them, a jump of the curvature bends them
  gaussian,   ///< colours of the Gaussian curvature: blue negative (saddle), white none, red positive
  mean,       ///< colours of the mean curvature
};

/// Their names, in the same order.
inline constexpr std::array<const char*, 6> kPatchStyles{"shaded", "lines", "isophotes", "zebra", "gaussian", "mean"};

struct PatchPictureOptions {
  PatchStyle style = PatchStyle::lines;
  int width = 800, height = 600;
  double from = 30;       ///< where the eye stands: degrees from the x axis, counter-clockwise seen from above
  double elevation = 30;  ///< and above the horizon
  int lines = 8;          ///< parameter lines of each family
  bool sides = true;      ///< draw the side curves
};

/// All patches in one picture that just holds them, in parallel projection on white, lit from beside the eye, both
/// sides of the surface alike. Exact normals in every pixel's triangle corners. Curvature colours are scaled to the
/// 95th percentile of their absolute values. `surfaces` are those of `patches`. Throws UsageError: a size under 16 or
/// over 20,000 pixels, no patches.
Image draw_patches(std::span<const Patch> patches, std::span<const PatchSurface> surfaces,
                   const PatchPictureOptions& options = {}, const Context& context = {});

}  // namespace retalho
