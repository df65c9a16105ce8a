// Real terrain with voids and without: no cracks, and every triangle within the tolerance of the surface.
#include <gtest/gtest.h>

#include <cmath>

#include "retalho/mesh/terrain_mesh.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"
#include "support/support.h"

namespace retalho {
namespace {

void expect_sound_meshes(const std::string& path, double tolerance) {
  const Raster raster = read_raster(path);
  const Tin tin = refine_tin(raster, {.vertices = 2000});
  for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
    const Terrain terrain = make_terrain(tin, raster, {.surface = kind});
    const TriangleMesh mesh = mesh_terrain(terrain, {.tolerance = tolerance});
    const MeshCheck check = check_mesh(mesh);
    EXPECT_TRUE(check.watertight()) << check.cracks << " cracks, " << check.nonmanifold_edges << " edges of no surface";
    EXPECT_EQ(check.degenerate_triangles, 0U);
    const TerrainEvaluator surface(terrain);
    std::size_t measured = 0;
    double largest = 0;
    for (const auto& v : mesh.triangles) {
      const Vec3 p = (mesh.positions[v[0]] + mesh.positions[v[1]] + mesh.positions[v[2]]) / 3;
      const double z = surface.value({p.x, p.y});
      if (std::isnan(z)) continue;
      ++measured;
      largest = std::max(largest, std::abs(z - p.z));
    }
    EXPECT_EQ(measured, mesh.triangles.size());
    EXPECT_LE(largest, tolerance * (1 + 1e-9)) << surface_name(kind);
  }
}

TEST(RealTerrainMesh, Crater) {
  RETALHO_DATA_FILE(path, "dem/crater.pgm");
  expect_sound_meshes(path, 2);
}

TEST(RealTerrainMesh, TileWithVoids) {
  RETALHO_DATA_FILE(path, "dem/N42E001.hgt.zip");
  const Raster raster = read_raster(path);
  EXPECT_LT(valid_mask(raster).count(), raster.cells()) << "no voids to test";
  expect_sound_meshes(path, 5);
}

}  // namespace
}  // namespace retalho
