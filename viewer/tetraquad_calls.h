// The TetraQuad view's calls: a surface's vertices, quadrics and tetrahedra for the page's ray caster, and the
// program's own ray caster to compare it with.
#pragma once

#include "calls.h"
#include "input_files.h"

namespace retalho::viewer {

inline constexpr std::size_t kMostTets = 400'000;  ///< the page draws

/// Adds /api/tetraquads/... to `table`.
void add_tetraquad_calls(CallTable& table, const InputFiles& inputs);

}  // namespace retalho::viewer
