// Checks of options' numbers. CLI11's own say which range they want with all 309 digits of the largest double.
#pragma once

#include <CLI/CLI.hpp>

namespace retalho::app {

/// "'-5' is not a number above 0"
CLI::Validator above_zero();
/// "'-5' is not a number of 0 or more"
CLI::Validator zero_or_more();

}  // namespace retalho::app
