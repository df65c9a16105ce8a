// Command lines, a word a line, and the words' own parsers. The commands' work is left out: nothing is read or written.
#include <cmath>
#include <limits>
#include <vector>

#include "command_line.h"
#include "commands/render_patches.h"
#include "commands/render_tetraquad.h"
#include "inputs.h"
#include "target.h"
#include "work_limits.h"

namespace {

using namespace retalho;

/// The commands without their callbacks, made once: CLI11 forgets the last parse before the next.
CLI::App& commands() {
  static app::Program program;
  static const auto root = [] {
    auto made = app::make_commands(program);
    for (CLI::App* command : made->get_subcommands({})) {
      command->callback({});
      command->parse_complete_callback({});
    }
    return made;
  }();
  return *root;
}

void parse_each(const std::string& word) {
  const auto refuse_or = [](const auto& parse) { fuzz::refuse_or(parse); };
  refuse_or([&] {
    const auto [width, height] = app::parse_size("--size", word);
    fuzz::require(width >= 16 && width <= 20000 && height >= 16 && height <= 20000, "a size that is none");
  });
  refuse_or([&] {
    const double share = app::parse_ratio("--ratio", word);
    fuzz::require(share > 0 && share <= 1, "a share that is none");
  });
  refuse_or([&] {
    const Vec2 p = app::parse_point("--at", word);
    fuzz::require(std::isfinite(p.x) && std::isfinite(p.y), "a point that is none");
  });
  refuse_or([&] { fuzz::require(app::parse_memory(word) >= 1, "a memory limit that is none"); });
  refuse_or([&] { fuzz::require(app::parse_seconds(word) > 0, "a time that is none"); });
  refuse_or([&] { app::parse_patch_style("--style", word); });
  refuse_or([&] {
    const CutPlane cut = parse_cut(word);
    fuzz::require(std::isfinite(cut.offset), "a cut that is none");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 2000) return 0;
  std::vector<std::string> words{"retalho"};
  std::string word;
  for (const char c : fuzz::text_of(data, size)) {
    if (c == '\0') continue;  // no word has one
    if (c != '\n') {
      word += c;
      continue;
    }
    words.push_back(std::move(word));
    word.clear();
  }
  if (!word.empty()) words.push_back(word);
  std::vector<const char*> argv;
  argv.reserve(words.size() + 1);
  for (const std::string& w : words) argv.push_back(w.c_str());
  argv.push_back(nullptr);
  fuzz::refuse_or([&] { app::parse_words(commands(), static_cast<int>(words.size()), argv.data()); });
  for (const std::string& w : words)
    if (w.size() < 100) parse_each(w);
  return 0;
}
