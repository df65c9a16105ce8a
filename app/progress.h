// Stages and the progress bar on standard error: two renderings of the same events (Context::progress).
#pragma once

#include <string_view>

namespace retalho::app {

/// Turns the bar on (where standard error is a terminal) and the stages with their times (`verbose`).
void start_progress(bool bar, bool verbose);
/// A stage's name and the fraction done. The bar shows once the work has passed a second, at most ten times a second.
void show_progress(std::string_view stage, double fraction);
/// Ends the last stage and wipes the bar, before other words are printed.
void clear_progress();
void end_progress();

}  // namespace retalho::app
