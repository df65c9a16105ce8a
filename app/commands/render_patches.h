// Drawing patches in `retalho render` and `retalho patch`.
#pragma once

#include <string>

#include "program.h"
#include "retalho/patch/patch.h"
#include "retalho/render/image.h"
#include "retalho/render/patch_picture.h"

namespace retalho::app {

/// "shaded", "lines", ... Throws UsageError.
PatchStyle parse_patch_style(const std::string& option, const std::string& word);
/// The surfaces of a set, in order.
std::vector<PatchSurface> surfaces_of(const std::vector<Patch>& patches, const Context& context);
/// "4 patches, smooth, 2244 nodes".
std::string kind_text(const PatchSet& set);
/// A picture of the set in `style`.
Image draw_patch_panel(const PatchSet& set, const std::string& style, std::optional<double> from, double elevation,
                       int width, int height, const Context& context);

}  // namespace retalho::app
