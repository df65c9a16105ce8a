// The curve view's calls: everything about the curves of a document (docs/curves.md), and exact changes of one of them.
#pragma once

#include "calls.h"

namespace retalho::viewer {

/// Adds /api/curves/... to `table`.
void add_curve_calls(CallTable& table);

}  // namespace retalho::viewer
