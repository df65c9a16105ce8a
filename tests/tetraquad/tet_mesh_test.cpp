// Meshes of tetrahedra: the grid of cubes, and the half-face structure against a slow twin.
#include "retalho/tetraquad/tet_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "retalho/core/error.h"
#include "support/support.h"

namespace retalho {
namespace {

std::vector<TetPlace> block(TetSplit split, int n) {
  std::vector<TetPlace> places;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        for (int t = 0; t < tets_of_cube(split); ++t)
          places.push_back({{i - 1, j - 1, k - 1}, static_cast<std::uint8_t>(t)});
  return places;
}

class MeshOnSplits : public testing::TestWithParam<TetSplit> {};
INSTANTIATE_TEST_SUITE_P(Both, MeshOnSplits, testing::Values(TetSplit::five, TetSplit::kuhn));

TEST_P(MeshOnSplits, FillACubeAndMatchAcrossFaces) {
  const TetMesh mesh = make_tet_mesh({0, 0, 0}, 1, GetParam(), block(GetParam(), 3));
  double volume = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) volume += std::abs(mesh.frame(t).volume6) / 6;
  EXPECT_NEAR(volume, 27, 1e-12);
  const HalfFaces faces(mesh.tets, mesh.lattice.size());
  // A block's border has two triangles a square: 6 sides of 9 squares.
  EXPECT_EQ(faces.border().size(), 108U);
  std::size_t parts = 0;
  faces.components(&parts);
  EXPECT_EQ(parts, 1U);
}

TEST_P(MeshOnSplits, TheOtherSideOfAFaceIsTheOneThatTheMeshFinds) {
  const TetMesh mesh = make_tet_mesh({0, 0, 0}, 1, GetParam(), block(GetParam(), 3));
  const HalfFaces faces(mesh.tets, mesh.lattice.size());
  for (std::size_t f = 0; f < 4 * mesh.tets.size(); ++f) {
    const TetPlace beyond = across(GetParam(), mesh.places[f / 4], static_cast<int>(f % 4));
    if (faces.is_border(f))
      EXPECT_FALSE(std::binary_search(mesh.places.begin(), mesh.places.end(), beyond));
    else
      EXPECT_EQ(mesh.places[static_cast<std::size_t>(faces.opposite(f)) / 4], beyond);
  }
}

TEST_P(MeshOnSplits, APointLiesInTheTetrahedronThatIsFound) {
  test::Random random(1);
  const TetMesh mesh = make_tet_mesh({10, -3, 4}, 0.5, GetParam(), block(GetParam(), 4));
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p = {10 + random.uniform(-0.5, 1.5), -3 + random.uniform(-0.5, 1.5), 4 + random.uniform(-0.5, 1.5)};
    TetBarycentric b;
    const std::int64_t t = mesh.locate(p, &b);
    ASSERT_GE(t, 0);
    Vec3 q{};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_GE(b[i], -1e-9);
      q = q + b[i] * mesh.position(mesh.tets[static_cast<std::size_t>(t)][i]);
    }
    EXPECT_LT(norm(p - q), 1e-13);
    EXPECT_EQ(place_of(GetParam(), mesh.to_lattice(p)), mesh.places[static_cast<std::size_t>(t)]);
  }
  EXPECT_EQ(mesh.locate({9, 0, 0}), -1);
  EXPECT_EQ(mesh.locate({1e300, 0, 0}), -1);
}

/// Everything by looking at all pairs.
struct SlowTwin {
  const std::vector<TetCorners>& tets;
  std::set<std::uint32_t> common(std::size_t a, std::size_t b) const {
    std::set<std::uint32_t> both;
    for (const std::uint32_t v : tets[a])
      if (std::find(tets[b].begin(), tets[b].end(), v) != tets[b].end()) both.insert(v);
    return both;
  }
  std::int64_t opposite(std::size_t half_face) const {
    for (std::size_t t = 0; t < tets.size(); ++t) {
      if (t == half_face / 4) continue;
      const auto both = common(half_face / 4, t);
      if (both.size() != 3 || both.contains(tets[half_face / 4][half_face % 4])) continue;
      for (std::size_t i = 0; i < 4; ++i)
        if (!both.contains(tets[t][i])) return static_cast<std::int64_t>(4 * t + i);
    }
    return -1;
  }
};

TEST(HalfFaces, AgreeWithABruteForceTwinOnRandomSelections) {
  test::Random random(2);
  for (int round = 0; round < 12; ++round) {
    const TetSplit split = round % 2 == 0 ? TetSplit::five : TetSplit::kuhn;
    std::vector<TetPlace> places = block(split, 3);
    std::erase_if(places, [&](const TetPlace&) { return random.chance(0.4); });
    const TetMesh mesh = make_tet_mesh({0, 0, 0}, 1, split, places);
    const HalfFaces faces(mesh.tets, mesh.lattice.size());
    const SlowTwin twin{mesh.tets};
    std::vector<std::uint32_t> border;
    for (std::uint32_t f = 0; f < 4 * mesh.tets.size(); ++f) {
      ASSERT_EQ(faces.opposite(f), twin.opposite(f));
      if (faces.opposite(f) >= 0) {
        ASSERT_EQ(faces.opposite(static_cast<std::size_t>(faces.opposite(f))), f);
      } else {
        border.push_back(f);
      }
    }
    EXPECT_EQ(faces.border(), border);
    for (std::uint32_t v = 0; v < mesh.lattice.size(); ++v) {
      std::vector<std::uint32_t> star, link;
      std::set<std::uint32_t> around;
      for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
        for (std::uint32_t i = 0; i < 4; ++i)
          if (mesh.tets[t][i] == v) {
            star.push_back(t);
            link.push_back(4 * t + i);
            around.insert(mesh.tets[t].begin(), mesh.tets[t].end());
          }
      around.erase(v);
      EXPECT_EQ(faces.star(v), star);
      EXPECT_EQ(faces.link(v), link);
      EXPECT_EQ(faces.neighbours(v), std::vector<std::uint32_t>(around.begin(), around.end()));
      for (const std::uint32_t w : around) {
        std::vector<std::uint32_t> both;
        for (const std::uint32_t t : star)
          if (std::find(mesh.tets[t].begin(), mesh.tets[t].end(), w) != mesh.tets[t].end()) both.push_back(t);
        EXPECT_EQ(faces.star(v, w), both);
      }
    }
  }
}

TEST(HalfFaces, RefuseWhatIsNoMesh) {
  EXPECT_THROW(HalfFaces({{0, 1, 2, 2}}, 4), BadInput);
  EXPECT_THROW(HalfFaces({{0, 1, 2, 4}}, 4), BadInput);
  EXPECT_THROW(HalfFaces({{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 5}}, 6), BadInput);
  EXPECT_EQ(HalfFaces({}, 0).tets(), 0U);
}

TEST(TetMesh, IsWrittenAsVtk) {
  const test::ScratchFolder folder;
  const TetMesh mesh = make_tet_mesh({0, 0, 0}, 2, TetSplit::five, block(TetSplit::five, 1));
  write_vtk(mesh, std::vector<double>(8, 1.5), folder / "tets.vtk");
  const std::string text = test::bytes_of(folder / "tets.vtk");
  EXPECT_NE(text.find("POINTS 8 double"), std::string::npos);
  EXPECT_NE(text.find("CELLS 5 25"), std::string::npos);
  EXPECT_NE(text.find("POINT_DATA 8"), std::string::npos);
  EXPECT_THROW(write_vtk(mesh, {1.0}, folder / "other.vtk"), UsageError);
  EXPECT_THROW(write_vtk(mesh, {}, folder / "tets.vtk"), CannotWrite);
}

}  // namespace
}  // namespace retalho
