// What the room's writers refuse, in its own words.
#include <gtest/gtest.h>

#include "retalho/core/error.h"
#include "retalho/mesh/mesh.h"
#include "retalho/mesh/terrain_mesh.h"
#include "support/errors.h"

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

}  // namespace
}  // namespace retalho::test
