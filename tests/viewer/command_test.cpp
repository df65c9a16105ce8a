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

TEST(ViewCommand, JsonIsShownByItsKeysAndWhatIsWrongInItIsSaidWithTheFile) {
  const ScratchFolder folder;
  const struct {
    const char *text, *words;
    int code;
  } cases[] = {
      {R"({"points": [1]})", "by the keys \"patches\", \"curves\" and \"tetrahedra\"", 3},
      {"[1]", "of a kind that the page does not show", 3},
      {"{\n", "is not JSON (line 2, column 1)", 4},
      {R"({"tiles": []})", "give its folder", 3},
      {R"({"tetrahedra": 3})", "'tetrahedra' must be an array", 3},
      {R"({"curves": [{"kind": "bezier", "points": [[0]]}]})", "curves[0].points[0]", 3},
      {R"({"curves": [{"kind": "bspline", "degree": 3, "points": [[0, 0], [1, 1]]}]})", "curves[0]", 3},
      {R"({"curves": [{"kind": "implicit", "f": "x +* y", "box": [0, 0, 1, 1]}]})", "x +* y", 3},
      {R"({"patches": [{"sides": [1, 2, 3]}]})", "patches[0].sides[0]", 3},
      {R"({"patches": [{"sides": [{"kind": "bezier", "points": [[0, 0, 0], [1, 0, 0]]},
                                  {"kind": "bezier", "points": [[5, 0, 0], [0, 1, 0]]},
                                  {"kind": "bezier", "points": [[0, 1, 0], [0, 0, 0]]}]}]})",
       "do not meet at corner V", 3},
  };
  for (const auto& one : cases) {
    folder.put("x.json", one.text);
    const Outcome outcome = run(folder, "view --no-browser x.json");
    EXPECT_EQ(outcome.code, one.code) << one.text;
    EXPECT_NE(outcome.err.find("x.json"), std::string::npos) << one.text << outcome.err;
    EXPECT_NE(outcome.err.find(one.words), std::string::npos) << one.text << outcome.err;
  }
}

}  // namespace
}  // namespace retalho::test
