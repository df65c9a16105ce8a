// retalho view: the page, in the browser, on this machine only.
#include <fmt/format.h>

#include "browser.h"
#include "needs_in_space.h"
#include "program.h"
#include "retalho/core/error.h"
#include "signals.h"
#include "viewer/viewer.h"
#include "work_limits.h"

namespace retalho::app {
namespace {

struct Options {
  std::vector<std::string> files;
  bool no_browser = false;
};

void run(const Program& program, const Options& options) {
  const Stopwatch watch;
  for (const std::string& file : options.files) check_shown_need(file);
  const viewer::InputFiles inputs = viewer::read_inputs(options.files, program.context());
  for (const viewer::TerrainInput& one : inputs.terrains) program.say(fmt::format("{}: {}", one.name, one.described));
  for (const viewer::TetraQuadInput& one : inputs.tetraquads)
    program.say(fmt::format("{}: {}", one.name, one.described));
  for (const viewer::CurvesInput& one : inputs.curves) program.say(fmt::format("{}: {}", one.name, one.described));
  for (const viewer::PatchInput& one : inputs.patches) program.say(fmt::format("{}: {}", one.name, one.described));
  for (const viewer::CloudInput& one : inputs.clouds) program.say(fmt::format("{}: {}", one.name, one.described));
  program.detail(fmt::format("reading: {:.3f} s", watch.seconds()));
  BrowserDoor door;
  end_softly();
  viewer::serve(inputs, program.threads, cancel_flag(), [&](const std::string& address) {
    if (program.json)
      program.print(nlohmann::ordered_json{{"address", address}});
    else if (options.no_browser)
      program.print(address + "\n");
    program.say("Ctrl-C ends it; the page works only while this program runs, and only on this machine");
    if (!options.no_browser && !door.open(address))
      program.print(fmt::format("no browser could be started: open this address yourself\n{}\n", address));
  });
  if (stopped_by_limit()) throw Interrupted();
  program.say("the page is closed");
}

}  // namespace

void add_view(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, program, "view", "The page, in the browser, on this machine only",
                                  "retalho view dem.tif\n"
                                  "retalho view dem.tif model.retalho\n"
                                  "retalho view bunny.retalho hull.json curves.json\n"
                                  "retalho view --no-browser dem.tif");
  command
      ->add_option(
          "FILE", options->files,
          "Elevation grids, models of every kind (tiled: the folder), points; curves, patches and quadrics as JSON")
      ->type_name("");
  command->add_flag("--no-browser", options->no_browser, "Print the address on standard output and open nothing");
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
