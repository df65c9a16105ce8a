// What the calls of the room refuse, in its own words: those that no command line can ask for.
#include <gtest/gtest.h>

#include "retalho/core/error.h"
#include "retalho/tetraquad/adaptive.h"
#include "retalho/tetraquad/block_cg.h"
#include "retalho/tetraquad/block_matrix.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/forest.h"
#include "retalho/tetraquad/tet_mesh.h"
#include "support/errors.h"
#include "support/sample_tetraquad.h"

namespace retalho::test {
namespace {

TEST(TetraQuadMessages, OptionsOutOfRangeAreNamed) {
  PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  cloud.normals = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  expect_refused<UsageError>({
      {"the options of the adaptive fit are out of range", [&] { fit_tetraquad_adaptive(cloud, {.roots = 1}); }},
      {"resolutions go from 2 to 1000, the finest not below the coarsest",
       [&] { fit_tetraquad_to(cloud, {.max_error = 1, .coarsest = 9, .finest = 8}); }},
      {"write_vtk: one number a vertex, or none", [] { write_vtk(sample_tetraquad().mesh, {1.0}, "none.vtk"); }},
  });
}

TEST(TetraQuadMessages, MeshesThatCannotBeNumberedAreNamed) {
  using Marks = std::vector<std::uint8_t>;
  Marks deep;  // one path down: of each tetrahedron the first half is cut again
  for (int level = 0; level <= TetForest::kDeepest; ++level) deep.push_back(1);
  for (int level = 0; level <= TetForest::kDeepest; ++level) deep.push_back(0);
  deep.insert(deep.end(), 6, 0);
  expect_refused<BadInput>({
      {"an adaptive mesh of more than 1000 root cubes along a side",
       [] {
         TetForest({{0, 0, 1000}});
       }},
      {"the root cubes of an adaptive mesh are out of order",
       [] {
         TetForest({{1, 0, 0}, {0, 0, 0}}, Marks(12, 0));
       }},
      {"an adaptive mesh with fewer marks than roots",
       [] {
         TetForest({{0, 0, 0}}, Marks(5, 0));
       }},
      {"the marks of an adaptive mesh end inside of a tree",
       [] {
         TetForest({{0, 0, 0}}, Marks(6, 1));
       }},
      {"an adaptive mesh of more than 27 levels",
       [&] {
         TetForest({{0, 0, 0}}, deep);
       }},
      {"an adaptive mesh with more marks than nodes",
       [] {
         TetForest({{0, 0, 0}}, Marks(7, 0));
       }},
      {"a tetrahedral grid of more than 2^20 cubes along a side",
       [] {
         make_tet_mesh({}, 1, TetSplit::five, {{{1 << 20, 0, 0}, 0}});
       }},
  });
}

TEST(TetraQuadMessages, AMatrixThatIsNotPositiveDefiniteIsNamed) {
  BlockMatrix matrix(1, {});
  matrix.add_ridge(-1);
  const std::vector<double> right(10, 1.0);
  std::vector<double> x(10);
  expect_refused<Error>({
      {"conjugate gradients: a diagonal block is not positive definite", [&] { solve_cg(matrix, right, x); }},
      {"the fit's matrix is not positive definite: raise the smoothness or the ridge", [&] { BlockCholesky{matrix}; }},
  });
}

}  // namespace
}  // namespace retalho::test
