#include "program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "progress.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "signals.h"
#include "work_limits.h"

namespace retalho::app {
namespace {

/// CLI11's help with the examples in front: who asks for help wants a line to copy.
class ExamplesFirst : public CLI::Formatter {
 public:
  explicit ExamplesFirst(std::string examples) : examples_(std::move(examples)) { column_width(36); }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    const std::string rest = CLI::Formatter::make_help(app, std::move(name), mode);
    return mode == CLI::AppFormatMode::Normal ? "Examples:\n" + examples_ + "\n" + rest : rest;
  }

 private:
  std::string examples_;
};

std::string indented(const std::string& lines) {
  std::string out;
  for (std::size_t at = 0; at < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', at), lines.size());
    out += "  " + lines.substr(at, end - at) + "\n";
    at = end + 1;
  }
  return out;
}

void write_stdout(const std::string& text) {
  clear_progress();
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written)
    throw CannotWrite(fmt::format("cannot write to standard output: {}", std::strerror(errno)), "standard output");
}

/// Levenshtein's distance.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

}  // namespace

Context Program::context() const {
  Context context;
  context.threads = threads;
  context.cancel = &cancel_flag();
  if (!quiet) {
    start_progress(true, verbose);
    context.progress = show_progress;
  }
  return context;
}

void Program::start() const {
  const double seconds = timeout.empty() ? 0 : parse_seconds(timeout);
  start_limits(seconds, memory.empty() ? default_memory_limit() : parse_memory(memory), say_stopped);
}

void Program::say(const std::string& words) const {
  if (quiet) return;
  clear_progress();
  fmt::print(stderr, "{}\n", words);
}

void Program::detail(const std::string& words) const {
  if (verbose) say(words);
}

void Program::print(const nlohmann::ordered_json& result) const {
  write_stdout(result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void Program::print(const std::string& text) const {
  write_stdout(text);
}

CLI::App* add_command(CLI::App& root, Program& program, const std::string& name, const std::string& summary,
                      const std::string& examples) {
  CLI::App* command = root.add_subcommand(name, summary);
  command->formatter(std::make_shared<ExamplesFirst>(indented(examples)));
  command->add_flag("--json", program.json, "Print the result as one JSON object")->group("Every command");
  command->add_flag("-q,--quiet", program.quiet, "No words but errors")->group("Every command");
  command->add_flag("-v,--verbose", program.verbose, "Say each stage with its time")->group("Every command");
  command->add_option("--threads", program.threads, "Worker threads (default: all; the result is the same)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->group("Every command");
  command->add_flag("--overwrite", program.overwrite, "Replace outputs that exist")->group("Every command");
  command->add_option("--timeout", program.timeout, "Stop after this time, with exit code 124 and no output")
      ->type_name("SECONDS")
      ->group("Every command");
  command
      ->add_option("--memory-limit", program.memory,
                   "Refuse work that needs more: bytes, or 512M, 2GB, 2GiB (default: three quarters of the machine's)")
      ->type_name("SIZE")
      ->group("Every command");
  command->parse_complete_callback([&program] { program.start(); });
  return command;
}

void check_output(const Program& program, const std::string& path, const std::vector<std::string>& endings,
                  const std::vector<std::string>& inputs) {
  namespace fs = std::filesystem;
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (!endings.empty() && std::find(endings.begin(), endings.end(), ending) == endings.end())
    throw UsageError(fmt::format("the output '{}' must end in {}", path, fmt::join(endings, ", ")), path);
  for (const std::string& input : inputs) {
    std::error_code ec;
    if (fs::equivalent(path, input, ec) && !ec)
      throw UsageError(fmt::format("the output '{}' is also an input: give another name", path), path);
  }
  const AtomicFile probe(path, program.overwrite);
}

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::size_t choose(const std::string& option, const std::string& word, const std::vector<std::string>& known) {
  const auto found = std::find(known.begin(), known.end(), word);
  if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
  const std::string guess = nearest(word, known);
  throw UsageError(fmt::format("{} is one of {}; not '{}'{}", option, fmt::join(known, ", "), word,
                               guess.empty() ? "" : fmt::format(". Did you mean '{}'?", guess)),
                   {}, option);
}

}  // namespace retalho::app
