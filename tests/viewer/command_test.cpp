// `retalho view` as a command: its help, and files that it cannot show, before any port is opened.
#include <gtest/gtest.h>

#include "cli/program.h"

namespace retalho::test {
namespace {

TEST(ViewCommand, HelpStartsWithExamples) {
  const ScratchFolder folder;
  const Outcome outcome = run(folder, "view --help");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out.rfind("Examples:\n  retalho view ", 0), 0U) << outcome.out;
  EXPECT_NE(outcome.out.find("--no-browser"), std::string::npos);
}

TEST(ViewCommand, FilesThatCannotBeShownAreErrorsOfTheProgram) {
  const ScratchFolder folder;
  EXPECT_EQ(run(folder, "view --no-browser missing.tif").code, 4);
  folder.put("text.tif", "not a raster");
  const Outcome text = run(folder, "view --no-browser --json text.tif");
  EXPECT_EQ(text.code, 4);
  EXPECT_EQ(text.json().at("error").at("kind"), "cannot_read");
  folder.put("void.asc", ascii_grid(4, 4, [](int, int) { return std::nan(""); }));
  const Outcome empty = run(folder, "view --no-browser void.asc");
  EXPECT_EQ(empty.code, 3);
  EXPECT_NE(empty.err.find("no surface"), std::string::npos) << empty.err;
  EXPECT_EQ(run(folder, "view --no-brwoser").code, 2);
}

}  // namespace
}  // namespace retalho::test
