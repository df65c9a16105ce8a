#include "command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "retalho/core/error.h"

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
void check_words(const CLI::App& root, int argc, const char* const* argv) {
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

}  // namespace

std::unique_ptr<CLI::App> make_commands(Program& program) {
  auto root = std::make_unique<CLI::App>("Smooth surfaces made of polynomial patches.", "retalho");
  root->formatter(std::make_shared<RootHelp>());
  root->require_subcommand(1);
  root->set_version_flag("--version", "retalho " RETALHO_VERSION);
  for (const auto add : kCommands) add(*root, program);
  return root;
}

std::optional<std::string> parse_words(CLI::App& root, int argc, const char* const* argv) {
  const auto chosen = [&root]() -> const CLI::App* {
    const auto commands = root.get_subcommands();
    return commands.empty() ? nullptr : commands.front();
  };
  try {
    check_words(root, argc, argv);
    root.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return chosen() ? chosen()->help("retalho") : root.help();
  } catch (const CLI::CallForVersion& version) {
    return std::string(version.what()) + "\n";
  } catch (const CLI::ParseError& error) {
    throw UsageError(
        fmt::format("{}. See `retalho {}--help`.", error.what(), chosen() ? chosen()->get_name() + " " : ""));
  }
  return std::nullopt;
}

}  // namespace retalho::app
