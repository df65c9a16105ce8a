// What the room's writers refuse, in its own words.
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <array>
#include <limits>
#include <string>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"
#include "retalho/mesh/globe_mesh.h"
#include "retalho/mesh/mesh.h"
#include "retalho/mesh/patch_cutter.h"
#include "retalho/mesh/terrain_mesh.h"
#include "support/errors.h"
#include "support/sample_terrain.h"
#include "support/support.h"

namespace retalho::test {
namespace {

TEST(MeshMessages, AreThese) {
  TriangleMesh one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}};
  one.unit = "furlong";
  expect_refused<CannotWrite>({
      {"a glTF file cannot hold a mesh without triangles", [] { encode_mesh({}, ".glb"); }},
      {"a LandXML surface cannot be without triangles", [] { encode_mesh({}, ".xml"); }},
      {"LandXML has metres and feet, and this mesh is in 'furlong': convert it first",
       [&] { encode_mesh(one, ".xml"); }},
  });
  expect_refused<BadInput>({
      {"a terrain without vertices has no mesh", [] { mesh_tolerance(Terrain{}, {}); }},
  });
  expect_refused<UsageError>({
      {"does not end in .ply, .obj, .stl, .glb, .xml or .landxml", [&] { write_mesh(one, "mesh.txt"); }},
  });
}

TEST(MeshMessages, APatchThatNoCutBringsNearIsNotCutForEver) {
  // No number is within NaN, and none is over it: edges stay whole, and nothing inside is near enough.
  PatchCutter<3> cutter({.tolerance = std::numeric_limits<double>::quiet_NaN()});
  cutter.start(0);
  const PatchCutter<3>::Net flat{};
  const std::array<Vec2, 3> p{Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}};
  const std::array v{cutter.add_vertex(p[0], 0, {}), cutter.add_vertex(p[1], 0, {}), cutter.add_vertex(p[2], 0, {})};
  cutter.set_patch(flat, p[0], p[1], p[2]);
  const std::array e{cutter.add_edge(0, 1, {}), cutter.add_edge(1, 2, {}), cutter.add_edge(2, 0, {})};
  expect_refused<Error>({
      {"a patch was cut 38 times over without coming close to the surface", [&] { cutter.cut(flat, v, e); }},
  });
}

TEST(MeshMessages, WhatAFormatCannotNumberIsSaidBeforeItIsWritten) {
  MeshStream mesh;
  mesh.vertices = std::uint64_t{1} << 31;
  mesh.triangles = std::uint64_t{1} << 32;
  std::string text;
  ByteSink out(text);
  expect_refused<CannotWrite>({
      {"an STL file holds at most 4,294,967,295 triangles", [&] { write_stl(mesh, out); }},
      {"a glTF file holds at most 4 GB and this mesh needs 7730941", [&] { write_glb(mesh, out); }},
  });
  out.close();
  EXPECT_TRUE(text.empty());
}

std::string utm() {
  OGRSpatialReference crs;
  crs.importFromEPSG(32611);
  char* wkt = nullptr;
  crs.exportToWkt(&wkt);
  std::string text = wkt;
  CPLFree(wkt);
  return text;
}

TEST(MeshMessages, AGlobeTakesPlacesOnTheEarth) {
  const ScratchFolder scratch;
  const std::string folder = scratch.path().string();
  Terrain here = sample_terrain({.kind = SurfaceKind::linear});
  here.georef.crs_wkt = utm();
  here.georef.origin_x = 500000;
  here.georef.origin_y = 4100000;
  Terrain nowhere = here;
  nowhere.georef.origin_x = 1e12;
  const TerrainEvaluator good(here), lost(nowhere);
  expect_refused<BadInput>({
      {"the model cannot be put on the globe: its corners have no longitudes and latitudes from -180 to 180",
       [&] { write_quantized_mesh(lost, folder); }},
      {"vertex 0 of the mesh cannot be put on the globe", [&] { write_tileset(nowhere, folder); }},
  });
  Terrain wide = here;
  wide.georef.scale_x = wide.georef.scale_y = 1e-4;  // 90 km a local unit
  const TerrainEvaluator far(wide);
  expect_refused<UsageError>({
      {"25 levels would make more than a million tiles: give a coarser one",
       [&] { write_quantized_mesh(far, folder, {.level = 24}); }},
  });
  for (const char* index : {"layer.json", "tileset.json"}) write_file(folder + "/" + index, "{}", false);
  expect_refused<CannotWrite>({
      {"layer.json' exists: --overwrite replaces it", [&] { write_quantized_mesh(good, folder, {.level = 8}); }},
      {"tileset.json' exists: --overwrite replaces it", [&] { write_tileset(here, folder); }},
  });
}

}  // namespace
}  // namespace retalho::test
