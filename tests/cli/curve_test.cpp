// retalho curve: pictures, round trips, JSON keys, errors with their places.
#include <gtest/gtest.h>

#include "cli/program.h"
#include "support/paths.h"

namespace retalho::test {
namespace {

std::string example(const std::string& name) {
  return source_folder() + "/examples/curves/" + name + ".json";
}

TEST(CurveCommand, ReportsJoinsMeasuresAndCrossings) {
  const ScratchFolder folder;
  const Outcome outcome = run(folder, "curve " + example("slide6") + " --json --crossings --closest 0.5,1 --at 0.25");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto c = outcome.json().at("curves").at(0);
  EXPECT_EQ(c.at("degree"), 3);
  EXPECT_EQ(c.at("segments"), 1);
  EXPECT_NEAR(c.at("length").get<double>(), 1.8284271247461903, 1e-12);
  ASSERT_EQ(c.at("joins").size(), 1U);
  EXPECT_EQ(c.at("joins").at(0).at("kind"), "cusp");
  EXPECT_EQ(c.at("joins").at(0).at("G"), "G0");
  EXPECT_EQ(c.at("self_intersections").size(), 0U);
  EXPECT_NEAR(c.at("closest").at(0).at("distance").get<double>(), 0.25, 1e-12);
}

TEST(CurveCommand, PicturesOfAllSortsAndTheirNumbersComeBack) {
  const ScratchFolder folder;
  const Outcome outcome =
      run(folder,
          "curve " + example("course") +
              " -o a.svg -o a.pdf -o a.png -o a.json -o a.gpkg --control --tangents --comb --joins --hodograph --axes");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(slurp(folder / "a.png").substr(1, 3), "PNG");
  EXPECT_EQ(slurp(folder / "a.pdf").substr(0, 5), "%PDF-");
  const auto first = run(folder, "curve a.svg --json").json().at("curves").at(0),
             direct = run(folder, "curve " + example("course") + " --json").json().at("curves").at(0);
  EXPECT_EQ(first.at("length"), direct.at("length"));
  EXPECT_EQ(first.at("bounds"), direct.at("bounds"));
  ASSERT_EQ(run(folder, "curve a.json -o b.json").code, 0);
  EXPECT_EQ(slurp(folder / "a.json"), slurp(folder / "b.json"));
  EXPECT_EQ(run(folder, "curve a.json -o b.json").code, 5);  // --overwrite is needed
  ASSERT_EQ(run(folder, "curve a.json -o c.json --convert bspline").code, 0);
  EXPECT_EQ(run(folder, "curve a.gpkg").code, 0);
}

TEST(CurveCommand, FormulasLooseNothing) {
  const ScratchFolder folder;
  const auto c = run(folder, "curve " + example("lemniscate") + " --json").json().at("curves").at(0);
  EXPECT_EQ(c.at("polynomial"), true);
  EXPECT_LT(c.at("visited_cells").get<double>(), 0.05 * c.at("grid_cells").get<double>());
  const auto poles = run(folder, "curve " + example("poles") + " --json").json().at("curves").at(0);
  EXPECT_EQ(poles.at("breaks").size(), 4U);
}

TEST(CurveCommand, ErrorsNameThePlace) {
  const ScratchFolder folder;
  folder.put("bad.json", R"({"curves":[{"kind":"bezier","points":[[0,0,0],[1,1]]}]})");
  const Outcome bad = run(folder, "curve bad.json --json");
  EXPECT_EQ(bad.code, 3);
  EXPECT_NE(bad.err.find("curves[0].points[1]: expected 3 numbers, got 2"), std::string::npos) << bad.err;
  EXPECT_EQ(bad.json().at("error").at("where"), "curves[0].points[1]");
  folder.put("f.json", R"J({"curves":[{"kind":"explicit","f":"foo(x)","from":0,"to":1}]})J");
  const Outcome formula = run(folder, "curve f.json");
  EXPECT_EQ(formula.code, 3);
  EXPECT_NE(formula.err.find("curves[0].f"), std::string::npos) << formula.err;
  EXPECT_EQ(run(folder, "curve none.json").code, 4);
  EXPECT_EQ(run(folder, "curve bad.json -o x.txt").code, 2);
  EXPECT_EQ(run(folder, "curve " + example("slide6") + " -o x.svg --size 10").code, 2);
  EXPECT_EQ(folder.entries(), 2U);
}

}  // namespace
}  // namespace retalho::test
