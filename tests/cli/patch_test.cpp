// retalho patch: meshes of three curves, JSON keys, errors with their places.
#include <gtest/gtest.h>

#include "cli/program.h"
#include "support/paths.h"

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
  EXPECT_EQ(counts.json().at("triangles"), 2 * counts.json().at("nodes").get<int>() - 2 - 39);
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

TEST(PatchCommand, SeveralPatchesArePicturedAndTheirJoinsTold) {
  const ScratchFolder folder;
  const std::string hull = source_folder() + "/examples/patches/hull.json";
  const Outcome outcome =
      run(folder, "patch " + hull + " -o a.png -o a.ply --refine 2 --style zebra --size 200x150 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = outcome.json();
  EXPECT_EQ(json.at("patches"), 4);
  EXPECT_LE(json.at("boundary_gap").get<double>(), 1e-13);
  EXPECT_LE(json.at("gradient_jump").get<double>(), 1e-11);
  ASSERT_EQ(json.at("joins").size(), 4U);
  for (const auto& join : json.at("joins")) {
    EXPECT_EQ(join.at("watertight"), true);
    EXPECT_EQ(join.at("kind"), "G0");
    EXPECT_GT(join.at("angle").get<double>(), 1);
  }
  EXPECT_EQ(slurp(folder / "a.png").substr(1, 3), "PNG");
  EXPECT_EQ(run(folder, "patch " + hull + " -o b.png --style stripes").code, 2);
}

TEST(PatchCommand, AMeshGetsParametersAndASurface) {
  const ScratchFolder folder;
  const std::string octant = source_folder() + "/examples/patches/octant.json";
  ASSERT_EQ(run(folder, "patch " + octant + " -o m.ply -o m.obj --divisions 20").code, 0);
  for (const char* kind : {"shape-preserving", "mean-value"}) {
    const Outcome outcome = run(folder, std::string("patch m.ply --json --at 0.3,0.3 --parameters ") + kind);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.json().at("triangles"), 400);
    EXPECT_NE(outcome.err.find("corners U, V, W"), std::string::npos);
    EXPECT_EQ(outcome.json().at("points").at(0).at("inside"), true);
  }
  EXPECT_EQ(run(folder, "patch m.obj -o fine.glb --refine 3").code, 0);
  const Outcome corner = run(folder, "patch m.ply --corners 0,1,30 --json");
  EXPECT_EQ(corner.code, 3);
  folder.put("two.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 4 5 6\n");
  const Outcome parts = run(folder, "patch two.obj --json");
  EXPECT_EQ(parts.code, 3);
  EXPECT_NE(parts.err.find("2 separate parts"), std::string::npos) << parts.err;
}

TEST(PatchCommand, TheModelFileServesTheOtherCommands) {
  const ScratchFolder folder;
  const std::string hull = source_folder() + "/examples/patches/hull.json";
  ASSERT_EQ(run(folder, "patch " + hull + " -o h.retalho --divisions 8").code, 0);
  const auto info = run(folder, "info h.retalho --json").json();
  EXPECT_EQ(info.at("kind"), "patches");
  EXPECT_EQ(info.at("patches"), 4);
  EXPECT_EQ(info.at("recovery"), "smooth");
  const Outcome mesh = run(folder, "mesh h.retalho -o h.stl --tolerance 0.002 --json");
  ASSERT_EQ(mesh.code, 0) << mesh.err;
  EXPECT_EQ(mesh.json().at("components"), 1);
  EXPECT_EQ(mesh.json().at("watertight"), true);
  EXPECT_LE(mesh.json().at("tolerance").get<double>(), 0.002);
  EXPECT_GT(mesh.json().at("triangles").get<int>(), 256);
  const std::string blade = source_folder() + "/examples/patches/blade.json";
  ASSERT_EQ(run(folder, "patch " + blade + " -o b.retalho").code, 0);  // its open ends lie over each other in plan
  EXPECT_EQ(run(folder, "mesh b.retalho -o b.ply --json").json().at("watertight"), true);
  ASSERT_EQ(run(folder, "render h.retalho -o h.png --style isophotes --size 200x200").code, 0);
  const auto before = run(folder, "patch " + hull + " --divisions 8 --json --at 0.2,0.3").json(),
             after = run(folder, "patch h.retalho --json --at 0.2,0.3").json();
  EXPECT_EQ(before.at("points"), after.at("points"));
  EXPECT_EQ(run(folder, "sample h.retalho -o x.tif").code, 3);
}

}  // namespace
}  // namespace retalho::test
