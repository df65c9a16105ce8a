// The curve view's calls: everything about the curves of a document (docs/curves.md), and exact changes of one of them.
#pragma once

#include "calls.h"
#include "input_files.h"
#include "retalho/curve/document.h"

namespace retalho::viewer {

/// Adds /api/curves/... to `table`.
void add_curve_calls(CallTable& table, const InputFiles& inputs);

/// Throws BadInput for more curves or points than the page shows.
void check_size(const CurveDocument& document);

}  // namespace retalho::viewer
