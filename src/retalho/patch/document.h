// Files of patches: the JSON form "patches" (docs/triangular-patches.md, "The file"), curves as in docs/curves.md.
//
//   {"curves": [{"name": "keel", ...}, ...],
//    "patches": [{"name": "bow", "sides": [CURVE, {"curve": "keel", "reversed": true}, 2], "divisions": 64}]}
//
// A side is a curve written out, the number or the name of one of "curves", or either with "reversed".
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retalho/patch/sides.h"

namespace retalho {

/// One entry of "patches", as it was written; join_sides comes after it.
struct PatchSpec {
  std::string name;
  std::string where;  ///< "patches[0]"
  PatchSides sides;
  std::optional<std::array<std::size_t, 3>> divisions;
};

/// A document without "patches" but with three "curves" is one patch. Implicit and explicit curves are refused.
/// Throws BadInput with the place ("patches[1].sides[0]"); for text that is not JSON with line and column.
std::vector<PatchSpec> parse_patches(std::string_view json, const std::string& file = {},
                                     SidePlacement placement = SidePlacement::parameter);
std::vector<PatchSpec> read_patches(const std::string& path, SidePlacement placement = SidePlacement::parameter);

}  // namespace retalho
