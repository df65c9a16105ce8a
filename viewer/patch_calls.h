// The triangular surfaces' calls: a patch from three curves, recovered, measured and coloured; and a point of it.
#pragma once

#include "calls.h"
#include "input_files.h"

namespace retalho::viewer {

inline constexpr std::size_t kMostPatches = 32;              ///< of a document
inline constexpr std::size_t kMostPatchTriangles = 400'000;  ///< the page draws

/// Adds /api/patches/... to `table`.
void add_patch_calls(CallTable& table, const InputFiles& inputs);

}  // namespace retalho::viewer
