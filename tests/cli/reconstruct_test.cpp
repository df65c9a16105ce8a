// The program's reconstruct command, run as a user runs it.
#include <gtest/gtest.h>

#include "cli/program.h"
#include "retalho/core/atomic_file.h"
#include "tetraquad/shapes.h"

namespace retalho::test {
namespace {

std::string xyz_of(const PointCloud& cloud) {
  std::string text;
  for (std::size_t k = 0; k < cloud.positions.size(); ++k) {
    const Vec3 p = cloud.positions[k], n = cloud.normals[k];
    text += fmt::format("{} {} {} {} {} {}\n", p.x, p.y, p.z, n.x, n.y, n.z);
  }
  return text;
}

TEST(Reconstruct, ATorusAsAMeshAndItsReport) {
  const ScratchFolder folder;
  folder.put("torus.xyz", xyz_of(torus_points(5000, 7)));
  const Outcome outcome =
      run(folder, "reconstruct torus.xyz -o torus.ply --resolution 10 --tetrahedra torus.vtk --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json json = outcome.json();
  EXPECT_EQ(json["points"], 5000);
  EXPECT_EQ(json["components"], 1);
  EXPECT_EQ(json["open_edges"], 0);
  EXPECT_EQ(json["genus"], 1);
  EXPECT_LT(json["residual_mean"].get<double>(), 1e-4);
  for (const char* key : {"vertices", "tetrahedra", "coefficients", "residual_max", "seconds"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(folder.entries(), 3U);
}

TEST(Reconstruct, PointsWithoutNormalsGetThemWithAWarning) {
  const ScratchFolder folder;
  std::string text;
  for (const Vec3& p : torus_points(5000, 7).positions) text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  folder.put("torus.xyz", text);
  const Outcome outcome = run(folder, "reconstruct torus.xyz -o torus.retalho --max-error 0.002 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("no normals"), std::string::npos);
  EXPECT_EQ(outcome.json()["genus"], 1);
  EXPECT_EQ(outcome.json()["open_edges"], 0);
  EXPECT_LE(outcome.json()["residual_quantile"].get<double>(), 0.002);
  const Outcome info = run(folder, "info torus.retalho --json");
  EXPECT_EQ(info.json()["kind"], "tetraquad");
  ASSERT_EQ(run(folder, "mesh torus.retalho -o torus.stl --tolerance 0.001").code, 0);
  ASSERT_EQ(run(folder, "render torus.retalho -o torus.png --size 200x200 --cut 'x<0' --outlines --jumps").code, 0);
  EXPECT_EQ(run(folder, "render torus.retalho -o other.png --cut 'q<0'").code, 2);
  EXPECT_EQ(run(folder, "sample torus.retalho -o torus.tif --resolution 1").code, 3);
  EXPECT_EQ(folder.entries(), 4U);
}

TEST(Reconstruct, AdaptiveSurfacesAreModelsAsOthersAre) {
  const ScratchFolder folder;
  folder.put("torus.xyz", xyz_of(torus_points(5000, 7)));
  const Outcome outcome = run(folder, "reconstruct torus.xyz -o torus.ply --adaptive 9000 --smoothness 0.1 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["genus"], 1);
  ASSERT_EQ(run(folder, "reconstruct torus.xyz -o torus.retalho --adaptive 9000 --smoothness 0.1").code, 0);
  const Outcome info = run(folder, "info torus.retalho --json");
  EXPECT_EQ(info.json()["coefficients"], outcome.json()["coefficients"]);
  // The model's triangles are the surface's, to the byte.
  ASSERT_EQ(run(folder, "mesh torus.retalho -o again.ply").code, 0);
  EXPECT_EQ(read_file(folder / "again.ply"), read_file(folder / "torus.ply"));
  ASSERT_EQ(run(folder, "render torus.retalho -o torus.png --size 200x200 --cut 'x<0' --outlines --jumps").code, 0);
  // Refined until the points are near enough.
  const Outcome near =
      run(folder, "reconstruct torus.xyz -o near.retalho --adaptive 30000 --max-error 0.0005 --smoothness 0.1 --json");
  ASSERT_EQ(near.code, 0) << near.err;
  EXPECT_LE(near.json()["residual_quantile"].get<double>(), 0.0005);
  EXPECT_LT(near.json()["coefficients"].get<int>(), 30000);
  EXPECT_EQ(run(folder, "reconstruct torus.xyz -o other.ply --adaptive 9000 --resolution 9").code, 2);
}

TEST(Reconstruct, ByConjugateGradientsAndLocally) {
  const ScratchFolder folder;
  folder.put("torus.xyz", xyz_of(torus_points(5000, 7)));
  const auto residual = [&](const std::string& how) {
    const Outcome outcome =
        run(folder, "reconstruct torus.xyz -o t.ply --overwrite --resolution 10 --json --fit " + how);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["open_edges"], 0);
    EXPECT_EQ(outcome.json()["iterations"].get<int>() > 0, how == "cg");
    return outcome.json()["residual_mean"].get<double>();
  };
  const double direct = residual("cholesky");
  EXPECT_NEAR(residual("cg") / direct, 1, 0.1);
  EXPECT_GT(residual("local"), 2 * direct);
  EXPECT_EQ(run(folder, "reconstruct torus.xyz -o u.ply --fit lu").code, 2);
}

TEST(Reconstruct, SaysWhatIsWrong) {
  const ScratchFolder folder;
  folder.put("torus.xyz", xyz_of(torus_points(500, 7)));
  folder.put("one.xyz", "1 2 3 0 0 1\n1 2 3 0 0 1\n");
  EXPECT_EQ(run(folder, "reconstruct torus.xyz -o torus.foo").code, 2);
  EXPECT_EQ(run(folder, "reconstruct torus.xyz -o torus.ply --resolution 1").code, 2);
  EXPECT_EQ(run(folder, "reconstruct torus.xyz -o torus.ply --split six").code, 2);
  EXPECT_EQ(run(folder, "reconstruct one.xyz -o one.ply").code, 3);
  EXPECT_EQ(run(folder, "reconstruct missing.xyz -o one.ply").code, 4);
  EXPECT_EQ(run(folder, "reconstruct torus.xyz -o no/torus.ply").code, 5);
  EXPECT_EQ(folder.entries(), 2U);
}

}  // namespace
}  // namespace retalho::test
