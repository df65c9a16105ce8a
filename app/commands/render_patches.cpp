#include "render_patches.h"

#include <fmt/format.h>

namespace retalho::app {

PatchStyle parse_patch_style(const std::string& option, const std::string& word) {
  static const std::vector<std::string> styles(kPatchStyles.begin(), kPatchStyles.end());
  return static_cast<PatchStyle>(choose(option, word, styles));
}

std::vector<PatchSurface> surfaces_of(const std::vector<Patch>& patches, const Context& context) {
  std::vector<PatchSurface> surfaces;
  surfaces.reserve(patches.size());
  for (const Patch& patch : patches) surfaces.emplace_back(patch, context);
  return surfaces;
}

std::string kind_text(const PatchSet& set) {
  std::size_t nodes = 0;
  for (const Patch& patch : set.patches) nodes += patch.positions.size();
  return fmt::format("{} {}, {}, {} nodes", set.patches.size(), set.patches.size() == 1 ? "patch" : "patches",
                     set.patches.empty() ? "" : recovery_name(set.patches[0].recovery), nodes);
}

Image draw_patch_panel(const PatchSet& set, const std::string& style, std::optional<double> from, double elevation,
                       int width, int height, const Context& context) {
  PatchPictureOptions options;
  options.style = parse_patch_style("--style", style);
  options.width = width;
  options.height = height;
  if (from) options.from = *from;
  options.elevation = elevation;
  return draw_patches(set.patches, surfaces_of(set.patches, context), options, context);
}

}  // namespace retalho::app
