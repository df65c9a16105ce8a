// What every subcommand shares: the options of all commands, messages, JSON and progress (docs/cli.md).
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "retalho/core/context.h"

namespace retalho::app {

/// The options that every command has, and the two ways to speak: data on standard output, words on standard error.
struct Program {
  bool json = false, quiet = false, verbose = false, overwrite = false;
  int threads = 0;

  Context context() const;                  ///< with threads, the signal handler's cancel flag and the progress bar
  void say(const std::string& words) const; ///< one line on standard error, unless --quiet
  void detail(const std::string& words) const;  ///< the same, only with --verbose
  void print(const nlohmann::ordered_json& result) const;  ///< the result as JSON on standard output; checks the write
  void print(const std::string& text) const;               ///< text on standard output; checks the write
};

/// Adds -q, -v, --json, --threads, --overwrite to a subcommand and, in front of its help, `examples` (one a line).
CLI::App* add_command(CLI::App& root, Program& program, const std::string& name, const std::string& summary,
                      const std::string& examples);

// One function a file of commands/: each adds its subcommand, whose callback does the work.
void add_info(CLI::App& root, Program& program);
void add_fit(CLI::App& root, Program& program);
void add_compare(CLI::App& root, Program& program);
void add_sample(CLI::App& root, Program& program);
void add_mesh(CLI::App& root, Program& program);
void add_render(CLI::App& root, Program& program);

}  // namespace retalho::app
