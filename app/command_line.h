// The words of a command line: the commands with their options, and what is said of words that are none.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "program.h"

namespace retalho::app {

/// All commands. `program` must outlive it: the options write there, and the commands' callbacks do the work.
std::unique_ptr<CLI::App> make_commands(Program& program);

/// Parses the words (argv[0] is the program) and runs the command. Returns what was asked for instead of work: the help
/// or the version. Throws UsageError for words that are not known, with the nearest known one, and whatever the work
/// throws.
std::optional<std::string> parse_words(CLI::App& root, int argc, const char* const* argv);

}  // namespace retalho::app
