// retalho patch: meshes of three curves, JSON keys, errors with their places.
#include <gtest/gtest.h>

#include "cli/program.h"

namespace retalho::test {
namespace {

const std::string kSides = R"({"patches": [{"name": "p", "divisions": 8, "sides": [
  {"kind": "bezier", "points": [[0,0,0],[0.5,0.1,0.3],[1,0,0]]},
  {"kind": "polyline", "points": [[1,0,0],[0.5,0.9,0]]},
  {"kind": "polyline", "points": [[0.5,0.9,0],[0,0,0]]}]}]})";

TEST(PatchCommand, WritesTrianglesInEveryFormat) {
  const ScratchFolder folder;
  folder.put("p.json", kSides);
  const Outcome outcome = run(folder, "patch p.json -o a.ply -o a.obj -o a.stl -o a.glb --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.json().at("patches"), 1);
  EXPECT_EQ(outcome.json().at("nodes"), 45);
  EXPECT_EQ(outcome.json().at("triangles"), 64);
  EXPECT_EQ(outcome.json().at("folds"), 0);
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.glb"}) EXPECT_GT(slurp(folder / name).size(), 500U);
  EXPECT_EQ(run(folder, "patch p.json -o a.ply").code, 5);
  const Outcome counts = run(folder, "patch p.json --divisions 7,12,20 --json");
  ASSERT_EQ(counts.code, 0) << counts.err;
  EXPECT_EQ(counts.json().at("boundary_edges"), 39);
}

TEST(PatchCommand, ErrorsNameThePlace) {
  const ScratchFolder folder;
  folder.put("gap.json", R"({"curves": [{"kind":"polyline","points":[[0,0],[1,0]]},
    {"kind":"polyline","points":[[1,0.5],[0,1]]}, {"kind":"polyline","points":[[0,1],[0,0]]}]})");
  const Outcome outcome = run(folder, "patch gap.json -o a.ply --json");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.json().at("error").at("where"), "corner V");
  EXPECT_NE(outcome.err.find("0.5 apart"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.entries(), 1U);
  EXPECT_EQ(run(folder, "patch gap.json -o a.ply --snap 0.5").code, 0);
  folder.put("kind.json", R"({"patches": [{"sides": [{"kind":"bezier","points":[[0,0],[1,1,1]]}, 1, 2]}]})");
  const Outcome place = run(folder, "patch kind.json --json");
  EXPECT_EQ(place.code, 3);
  EXPECT_EQ(place.json().at("error").at("where"), "patches[0].sides[0].points[1]");
  folder.put("two.json", R"({"patches": [{"sides": [0, 1]}]})");
  EXPECT_EQ(run(folder, "patch two.json").code, 3);
  EXPECT_EQ(run(folder, "patch gap.json --recovery exact").code, 2);
  EXPECT_EQ(run(folder, "patch missing.json").code, 4);
}

}  // namespace
}  // namespace retalho::test
