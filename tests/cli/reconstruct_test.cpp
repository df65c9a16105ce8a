// The program's reconstruct command, run as a user runs it.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

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

TEST(Reconstruct, ClosesAShapeThatIsSaidToBeClosed) {
  const ScratchFolder folder;
  PointCloud half = sphere_points(6000, {0, 0, 0}, 1), cap;
  for (std::size_t k = 0; k < half.positions.size(); ++k)
    if (half.positions[k].z > -0.6) {
      cap.positions.push_back(half.positions[k]);
      cap.normals.push_back(half.normals[k]);
    }
  folder.put("cap.xyz", xyz_of(cap));
  const Outcome open = run(folder, "reconstruct cap.xyz -o open.ply --resolution 16 --json");
  ASSERT_EQ(open.code, 0) << open.err;
  EXPECT_GT(open.json()["open_edges"].get<int>(), 20);
  const Outcome closed = run(folder, "reconstruct cap.xyz -o closed.ply --resolution 16 --closed --json");
  ASSERT_EQ(closed.code, 0) << closed.err;
  EXPECT_EQ(closed.json()["open_edges"], 0);
  EXPECT_EQ(closed.json()["genus"], 0);
}

TEST(Reconstruct, LeavesOutPartsThatAreNotAskedFor) {
  const ScratchFolder folder;
  PointCloud cloud = sphere_points(3000, {0, 0, 0}, 0.5);
  for (const PointCloud& more : {sphere_points(500, {1.3, 0, 0}, 0.3), sphere_points(60, {1.3, 1.3, 0}, 0.15)}) {
    cloud.positions.insert(cloud.positions.end(), more.positions.begin(), more.positions.end());
    cloud.normals.insert(cloud.normals.end(), more.normals.begin(), more.normals.end());
  }
  folder.put("balls.xyz", xyz_of(cloud));
  const std::string command = "reconstruct balls.xyz --resolution 14 --overwrite ";
  const Outcome all = run(folder, command + "-o all.ply --json");
  ASSERT_EQ(all.code, 0) << all.err;
  EXPECT_EQ(all.json()["parts"], 3);
  EXPECT_EQ(all.json()["parts_left_out"], 0);
  EXPECT_NEAR(all.json()["part_list"][2]["points"].get<int>(), 59, 1);
  EXPECT_NE(all.err.find("the surface has 3 parts, "), std::string::npos) << all.err;
  for (const auto& [option, kept] :
       {std::pair{"--parts 1", 1}, {"--parts 9", 3}, {"--part-points 61", 2}, {"--parts 2 --part-points 501", 1}}) {
    for (const std::string file : {"some.ply", "some.retalho"}) {
      const Outcome some = run(folder, command + option + " --json -o " + file);
      ASSERT_EQ(some.code, 0) << some.err;
      EXPECT_EQ(some.json()["components"], kept) << option;
      EXPECT_EQ(some.json()["parts_left_out"], 3 - kept);
      EXPECT_EQ(some.json()["open_edges"], 0);
      EXPECT_EQ(some.json()["part_list"][0]["kept"], true);
      EXPECT_EQ(some.err.find("left out") != std::string::npos, kept < 3) << some.err;
    }
    // The model's triangles are the same.
    ASSERT_EQ(run(folder, "mesh some.retalho -o again.ply --overwrite").code, 0);
    EXPECT_EQ(read_file(folder / "again.ply").size(), read_file(folder / "some.ply").size());
  }
}

TEST(Reconstruct, MillimetresFiveThousandKilometresOut) {
  // A field of 20 m with waves of 3 mm, written with a tenth of a millimetre, far from the origin as surveys are.
  const ScratchFolder folder;
  Random random(91);
  std::string text;
  const auto height = [](double x, double y) { return 300 + 0.003 * std::sin(x) * std::cos(0.8 * y); };
  for (int n = 0; n < 20000; ++n) {
    const double x = random.uniform(0, 20), y = random.uniform(0, 20);
    const double east = -0.003 * std::cos(x) * std::cos(0.8 * y), north = 0.0024 * std::sin(x) * std::sin(0.8 * y);
    text +=
        fmt::format("{:.4f} {:.4f} {:.4f} {:.9f} {:.9f} {:.9f}\n", 5e6 + x, 5.5e6 + y, height(x, y),
                    east / std::sqrt(1 + east * east + north * north),
                    north / std::sqrt(1 + east * east + north * north), 1 / std::sqrt(1 + east * east + north * north));
  }
  folder.put("field.xyz", text);
  ASSERT_EQ(run(folder, "reconstruct field.xyz -o field.retalho --resolution 24").code, 0);
  ASSERT_EQ(run(folder, "mesh field.retalho -o field.obj").code, 0);
  std::istringstream lines(read_file(folder / "field.obj"));
  std::size_t seen = 0;
  double lowest = 1e9, highest = -1e9;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("v ", 0) != 0) continue;
    std::istringstream words(line.substr(2));
    Vec3 p;
    words >> p.x >> p.y >> p.z;
    p = p - Vec3{5e6, 5.5e6, 0};
    if (p.x < 0.2 || p.x > 19.8 || p.y < 0.2 || p.y > 19.8) continue;
    EXPECT_NEAR(p.z, height(p.x, p.y), 2e-4);
    lowest = std::min(lowest, p.z);
    highest = std::max(highest, p.z);
    ++seen;
  }
  EXPECT_GT(seen, 1000U);
  EXPECT_NEAR(highest - lowest, 0.006, 3e-4);
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
