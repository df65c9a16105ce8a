// What docs/cli.md says of all commands: help, exit codes, JSON errors, standard output.
#include <gtest/gtest.h>

#include "cli/program.h"
#include "support/paths.h"

namespace retalho::test {
namespace {

const std::vector<std::string>& commands() {
  static const std::vector<std::string> names{"info", "fit", "compare", "sample", "mesh", "render", "curve", "patch"};
  return names;
}

TEST(EveryCommand, HelpStartsWithExamplesThatNameTheCommand) {
  const ScratchFolder folder;
  for (const std::string& name : commands()) {
    const Outcome outcome = run(folder, name + " --help");
    EXPECT_EQ(outcome.code, 0) << name;
    EXPECT_EQ(outcome.out.rfind("Examples:\n  retalho " + name + " ", 0), 0U) << outcome.out;
    EXPECT_NE(outcome.out.find("Usage: retalho " + name), std::string::npos) << outcome.out;
    for (const char* option : {"--json", "-q,--quiet", "-v,--verbose", "--threads", "--overwrite"})
      EXPECT_NE(outcome.out.find(option), std::string::npos) << name << " " << option;
    EXPECT_EQ(outcome.err, "");
  }
  const Outcome root = run(folder, "--help");
  EXPECT_EQ(root.code, 0);
  EXPECT_EQ(root.out.rfind("Examples:\n", 0), 0U);
  for (const std::string& name : commands()) EXPECT_NE(root.out.find("\n  " + name + " "), std::string::npos) << name;
}

TEST(EveryCommand, MissingArgumentsAreUsageErrors) {
  const ScratchFolder folder;
  EXPECT_EQ(run(folder, "").code, 2);
  for (const std::string& name : commands()) {
    const Outcome outcome = run(folder, name + " --json");
    EXPECT_EQ(outcome.code, 2) << name;
    EXPECT_EQ(outcome.json().at("error").at("kind"), "usage");
    EXPECT_EQ(outcome.json().at("error").at("code"), 2);
    EXPECT_NE(outcome.err.find(name + " --help"), std::string::npos) << outcome.err;
  }
}

TEST(EveryCommand, WrongWordsGetTheNearestRightOne) {
  const ScratchFolder folder;
  const Outcome command = run(folder, "inffo x");
  EXPECT_EQ(command.code, 2);
  EXPECT_NE(command.err.find("Did you mean 'info'?"), std::string::npos) << command.err;
  for (const std::string& name : commands()) {
    const Outcome option = run(folder, name + " --overwrit");
    EXPECT_EQ(option.code, 2);
    EXPECT_NE(option.err.find("Did you mean '--overwrite'?"), std::string::npos) << option.err;
  }
}

TEST(EveryCommand, Version) {
  const ScratchFolder folder;
  const Outcome outcome = run(folder, "--version");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out, "retalho " + slurp(source_folder() + "/VERSION"));
}

TEST(EveryCommand, StandardOutputThatCannotBeWrittenIsExit5) {
  const ScratchFolder folder;
  folder.put("g.asc", ascii_grid(5, 4, hills));
  for (const std::string& arguments :
       {std::string("--help"), std::string("--version"), std::string("info g.asc"), std::string("info g.asc --json")}) {
    const Outcome full = run(folder, arguments, ">/dev/full");
    EXPECT_EQ(full.code, 5) << arguments;
    EXPECT_NE(full.err.find("standard output"), std::string::npos) << full.err;
    EXPECT_EQ(run(folder, arguments, ">&-").code, 5) << arguments;
  }
}

TEST(Info, RasterKeys) {
  const ScratchFolder folder;
  folder.put("g.asc", ascii_grid(5, 4, [](int c, int r) { return c == 0 && r == 0 ? std::nan("") : c + 10.0 * r; }));
  const Outcome outcome = run(folder, "info g.asc --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_EQ(json.at("kind"), "raster");
  EXPECT_EQ(json.at("columns"), 5);
  EXPECT_EQ(json.at("rows"), 4);
  EXPECT_EQ(json.at("cells"), 20);
  EXPECT_EQ(json.at("valid_cells"), 19);
  EXPECT_EQ(json.at("minimum"), 1);
  EXPECT_EQ(json.at("maximum"), 34);
  EXPECT_EQ(json.at("bounds"), (nlohmann::json{1000.0, 2000.0, 1050.0, 2040.0}));
  EXPECT_EQ(json.at("nodata"), -9999);
  EXPECT_EQ(run(folder, "info g.asc --nodata 34 --json").json().at("valid_cells"), 18);
  const Outcome text = run(folder, "info g.asc");
  EXPECT_NE(text.out.find("\ncolumns      5\n"), std::string::npos) << text.out;
}

TEST(Info, PointKeys) {
  const ScratchFolder folder;
  folder.put("p.xyz", "0 0 5\n10 0 6\n0 10 7\n");
  const auto json = run(folder, "info p.xyz --json").json();
  EXPECT_EQ(json.at("kind"), "points");
  EXPECT_EQ(json.at("points"), 3);
  EXPECT_EQ(json.at("minimum"), 5);
  EXPECT_EQ(json.at("maximum"), 7);
  EXPECT_EQ(json.at("bounds"), (nlohmann::json{0.0, 0.0, 10.0, 10.0}));
}

TEST(Info, ErrorsHaveTheirCodes) {
  const ScratchFolder folder;
  folder.put("g.asc", ascii_grid(5, 4, hills));
  folder.put("nonsense.tif", "this is no raster");
  folder.put("short.retalho", "RETALHO");
  const Outcome missing = run(folder, "info missing.tif --json");
  EXPECT_EQ(missing.code, 4);
  EXPECT_EQ(missing.json().at("error").at("file"), "missing.tif");
  EXPECT_EQ(missing.json().at("error").at("kind"), "cannot_read");
  EXPECT_EQ(run(folder, "info nonsense.tif").code, 4);
  EXPECT_EQ(run(folder, "info short.retalho").code, 4);
  EXPECT_EQ(run(folder, "info g.asc --band 2").code, 3);
  EXPECT_EQ(run(folder, "info g.asc --band x").code, 2);
}

}  // namespace
}  // namespace retalho::test
