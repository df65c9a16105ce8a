// The triangular surfaces' calls: a patch from three curves, recovered, measured and coloured; and a point of it.
#pragma once

#include "calls.h"

namespace retalho::viewer {

/// Adds /api/patches/... to `table`.
void add_patch_calls(CallTable& table);

}  // namespace retalho::viewer
