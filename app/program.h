// What every subcommand shares: the options of all commands, messages, JSON and progress (docs/cli.md).
//
// To add a command: one file in commands/ with `void add_NAME(CLI::App&, Program&)`, its declaration at the end of this
// header, one row in the table of command_line.cpp, one page docs/commands/NAME.md, and its tests in tests/cli/.
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "retalho/core/context.h"

namespace retalho::app {

/// The options that every command has, and the two ways to speak: data on standard output, words on standard error.
struct Program {
  /// Says why the work is ended by force, and returns the exit code (main.cpp).
  std::function<int()> say_stopped;
  bool json = false, quiet = false, verbose = false, overwrite = false;
  int threads = 0;
  std::string timeout, memory;  ///< --timeout, --memory-limit

  /// With threads, the signal handler's cancel flag and the progress bar. Call it once a command: the bar's stages are
  /// counted from here. The Context must not outlive the Program.
  Context context() const;
  /// Starts the clock and the watch (work_limits.h). Throws UsageError. Called when the options are known.
  void start() const;
  void say(const std::string& words) const;                ///< one line on standard error, unless --quiet
  void detail(const std::string& words) const;             ///< the same, only with --verbose
  void print(const nlohmann::ordered_json& result) const;  ///< the result as JSON on standard output; checks the write
  void print(const std::string& text) const;               ///< text on standard output; checks the write
};

/// Seconds since it was made.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Adds -q, -v, --json, --threads, --overwrite, --timeout, --memory-limit to a subcommand and, in front of its help,
/// `examples` (one a line).
CLI::App* add_command(CLI::App& root, Program& program, const std::string& name, const std::string& summary,
                      const std::string& examples);

/// Throws CannotWrite when `path` cannot be made (it exists without --overwrite, its folder is missing), and UsageError
/// when it is one of `inputs` or its ending is not among `endings` (".ply", ...; none: any). For use before the work
/// starts.
void check_output(const Program& program, const std::string& path, const std::vector<std::string>& endings,
                  const std::vector<std::string>& inputs);

/// The one of `known` nearest to `word` by spelling, or empty when none is near.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

/// Throws UsageError, with the choices and the nearest, when `word` is not among `known`. Returns its place.
std::size_t choose(const std::string& option, const std::string& word, const std::vector<std::string>& known);

// One function a file of commands/: each adds its subcommand, whose callback does the work.
void add_info(CLI::App& root, Program& program);
void add_fit(CLI::App& root, Program& program);
void add_compare(CLI::App& root, Program& program);
void add_sample(CLI::App& root, Program& program);
void add_mesh(CLI::App& root, Program& program);
void add_render(CLI::App& root, Program& program);
void add_curve(CLI::App& root, Program& program);
void add_patch(CLI::App& root, Program& program);
void add_viewshed(CLI::App& root, Program& program);
void add_contour(CLI::App& root, Program& program);
void add_reconstruct(CLI::App& root, Program& program);
void add_view(CLI::App& root, Program& program);

}  // namespace retalho::app
