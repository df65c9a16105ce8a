// The program `retalho`: its subcommands, and the one place where errors become messages and exit codes.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <new>

#include "inputs.h"
#include "program.h"
#include "progress.h"
#include "retalho/core/error.h"
#include "signals.h"
#include "work_limits.h"

namespace retalho::app {
namespace {

// A new command is one row here.
constexpr void (*kCommands[])(CLI::App&, Program&) = {
    add_info,  add_fit,   add_compare, add_sample,   add_mesh,        add_render,
    add_curve, add_patch, add_contour, add_viewshed, add_reconstruct, add_view,
};

constexpr const char* kExamples =
    "Examples:\n"
    "  retalho fit dem.tif -o dem.retalho --max-error 2\n"
    "  retalho compare dem.tif dem.retalho\n"
    "  retalho sample dem.retalho -o smooth.tif --like dem.tif\n"
    "  retalho render dem.tif dem.retalho -o picture.png\n"
    "  retalho COMMAND --help\n";

class RootHelp : public CLI::Formatter {
 public:
  RootHelp() { column_width(20); }
  std::string make_help(const CLI::App* root, std::string name, CLI::AppFormatMode mode) const override {
    return std::string(kExamples) + "\n" + CLI::Formatter::make_help(root, std::move(name), mode);
  }
};

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string guess = nearest(word, known);
  return guess.empty() ? std::string() : fmt::format(" Did you mean '{}'?", guess);
}

/// Unknown commands and options, with the nearest known one: CLI11 would only say that they were not expected.
void check_words(const CLI::App& root, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* command : root.get_subcommands({})) names.push_back(command->get_name());
  int first = 1;
  while (first < argc && argv[first][0] == '-') ++first;
  if (first >= argc) return;
  const std::string name = argv[first];
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw UsageError(fmt::format("there is no command '{}'.{} `retalho --help` lists the commands.", name,
                                 did_you_mean(name, names)));
  const CLI::App* command = root.get_subcommand(name);
  for (int i = first + 1; i < argc && std::strcmp(argv[i], "--") != 0; ++i) {
    const std::string word(argv[i], std::strcspn(argv[i], "="));
    if (word.size() < 3 || word.compare(0, 2, "--") != 0 || command->get_option_no_throw(word)) continue;
    std::vector<std::string> options;
    for (const CLI::Option* option : command->get_options())
      for (const std::string& known : option->get_lnames()) options.push_back("--" + known);
    throw UsageError(fmt::format("`retalho {0}` has no option '{1}'.{2} `retalho {0} --help` lists its options.", name,
                                 word, did_you_mean(word, options)),
                     {}, word);
  }
}

int fail(bool json, int code, const char* kind, const std::string& message, const std::string& file = {},
         const std::string& where = {}) {
  end_progress();
  fmt::print(stderr, "retalho: {}\n", message);
  if (!json) return code;
  nlohmann::ordered_json error = {{"code", code}, {"kind", kind}, {"message", message}};
  if (!file.empty()) error["file"] = file;
  if (!where.empty()) error["where"] = where;
  try {
    Program{}.print(nlohmann::ordered_json{{"error", error}});
  } catch (const std::exception&) {  // standard output is gone: the message and the code have to do
  }
  return code;
}

/// Errors about inputs name the file, whichever step found them.
int fail(bool json, const Error& error) {
  std::string message = error.what(), file = error.file();
  const bool about_input = error.kind() == Error::Kind::bad_input || error.kind() == Error::Kind::cannot_read;
  if (about_input && file.empty()) file = noted_input();
  if (about_input && !file.empty() && message.find(file) == std::string::npos)
    message = fmt::format("'{}': {}", file, message);
  return fail(json, error.exit_code(), kind_name(error.kind()), message, file, error.where());
}

int fail_stopped(bool json) {
  if (const std::optional<Stop> stop = stopped_by_limit())
    return fail(json, stop->code, stop->kind, stop->message, noted_input(), stop->where);
  return fail(json, Interrupted());
}

int run(int argc, char** argv) {
  catch_signals();
  // GDAL would keep blocks in a twentieth of the machine's memory: a few rows of blocks are all that we come back to.
  setenv("GDAL_CACHEMAX", "64", 0);
  const struct Limits {
    ~Limits() { stop_limits(); }
  } limits;
  const bool json = std::any_of(argv + 1, argv + argc, [](const char* a) { return std::strcmp(a, "--json") == 0; });
  const auto internal = [&](const std::string& words) {
    return fail(json, static_cast<int>(Error::Kind::internal), kind_name(Error::Kind::internal), words);
  };
  try {
    Program program;
    program.say_stopped = [json] { return fail_stopped(json); };
    CLI::App root("Smooth surfaces made of polynomial patches.", "retalho");
    root.formatter(std::make_shared<RootHelp>());
    root.require_subcommand(1);
    root.set_version_flag("--version", "retalho " RETALHO_VERSION);
    for (const auto add : kCommands) add(root, program);
    try {
      check_words(root, argc, argv);
      root.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
      const auto chosen = root.get_subcommands();
      program.print(chosen.empty() ? root.help() : chosen.front()->help("retalho"));
    } catch (const CLI::CallForVersion& version) {
      program.print(std::string(version.what()) + "\n");
    } catch (const CLI::ParseError& error) {
      const auto chosen = root.get_subcommands();
      const std::string help = chosen.empty() ? "retalho --help" : "retalho " + chosen.front()->get_name() + " --help";
      throw UsageError(fmt::format("{}. See `{}`.", error.what(), help));
    }
    end_progress();
    return 0;
  } catch (const Error& error) {
    return stopped_by_limit() ? fail_stopped(json) : fail(json, error);  // whatever the stopped step says of itself
  } catch (const std::bad_alloc&) {
    return internal("out of memory: the work does not fit; try a smaller input or a larger tolerance");
  } catch (const std::exception& error) {
    return internal(fmt::format("failed inside: {}. Please report it with the command line.", error.what()));
  }
}

}  // namespace
}  // namespace retalho::app

int main(int argc, char** argv) {
  return retalho::app::run(argc, argv);
}
