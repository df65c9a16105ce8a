// The editable triangulation: after any edits it is sound, exactly Delaunay, and covers the hull.
#include "retalho/tin/cell_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "retalho/tin/grid_hull.h"
#include "support/grids.h"
#include "support/support.h"

namespace retalho {
namespace {

using greedy::area2;
using greedy::Cell;
using greedy::cell_at;

std::int64_t turn(Cell a, Cell b, Cell c) {
  return area2(a, c, b);
}

void check(const CellMesh& mesh, std::int64_t hull_area2) {
  std::int64_t area = 0;
  std::set<Cell> seen;
  for (const Cell c : mesh.cells()) EXPECT_TRUE(seen.insert(c).second);
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto& v = mesh.triangles()[t];
    const std::int64_t a2 = turn(mesh.cell(v[0]), mesh.cell(v[1]), mesh.cell(v[2]));
    ASSERT_GT(a2, 0);
    area += a2;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t n = mesh.neighbors()[t][k];
      if (n == kNone) continue;
      const auto& w = mesh.triangles()[n];
      ASSERT_TRUE(std::count(w.begin(), w.end(), v[(k + 1) % 3]) == 1 &&
                  std::count(w.begin(), w.end(), v[(k + 2) % 3]) == 1);
      const auto& back = mesh.neighbors()[n];
      ASSERT_EQ(std::count(back.begin(), back.end(), t), 1);
      for (const std::uint32_t far : w)
        if (far != v[(k + 1) % 3] && far != v[(k + 2) % 3]) {
          ASSERT_FALSE(greedy::in_circle(mesh.cell(v[0]), mesh.cell(v[2]), mesh.cell(v[1]), mesh.cell(far)));
        }
    }
  }
  EXPECT_EQ(area, hull_area2);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    const auto& t = mesh.triangles()[mesh.triangle_at(v)];
    ASSERT_EQ(std::count(t.begin(), t.end(), v), 1);
    CellMesh::Star star;
    mesh.star(v, star);
    EXPECT_EQ(star.closed, !mesh.on_border(v));
    EXPECT_EQ(star.ring.size(), star.triangles.size() + (star.closed ? 0 : 1));
  }
}

std::int64_t area_of(const CellMesh& mesh) {
  std::int64_t area = 0;
  for (const auto& v : mesh.triangles()) area += turn(mesh.cell(v[0]), mesh.cell(v[1]), mesh.cell(v[2]));
  return area;
}

TEST(CellMesh, StaysDelaunayUnderAnyEdits) {
  test::Random random;
  for (const bool voids : {false, true})
    for (const int side : {5, 12, 60}) {
      const Raster raster = test::make_grid(side, side - 1, [&](int x, int y) {
        return voids && (x + y < side / 2 || x - 2 * y > side / 2) ? std::nanf("") : 1.0F;
      });
      CellMesh mesh(greedy::hull_of_valid(raster));
      const std::int64_t area = area_of(mesh);
      check(mesh, area);
      for (int step = 0; step < 600; ++step) {
        const int what = static_cast<int>(random.index(10));
        const auto vertex = static_cast<std::uint32_t>(random.index(mesh.vertex_count()));
        const Cell cell = cell_at(static_cast<int>(random.index(static_cast<std::size_t>(side))),
                                  static_cast<int>(random.index(static_cast<std::size_t>(side - 1))));
        const auto from = static_cast<std::uint32_t>(random.index(mesh.triangle_count()));
        if (what < 5) {
          const std::size_t before = mesh.vertex_count();
          const bool known = std::count(mesh.cells().begin(), mesh.cells().end(), cell) > 0;
          const std::uint32_t made = mesh.insert(cell, from);
          if (known) {
            EXPECT_EQ(made, kNone);
          }
          if (!voids && !known) {
            EXPECT_EQ(made, before);
          }
          EXPECT_EQ(mesh.vertex_count(), before + (made == kNone ? 0 : 1));
        } else if (what < 8) {
          const std::size_t before = mesh.vertex_count();
          const Cell last = mesh.cells().back();
          if (mesh.remove(vertex)) {
            EXPECT_EQ(mesh.vertex_count(), before - 1);
            if (vertex + 1 < before) {
              EXPECT_EQ(mesh.cell(vertex), last);
            }
          }
        } else if (mesh.can_move(vertex, cell)) {
          mesh.displace(vertex, cell);
          mesh.restore();
        }
        if (step % 20 == 0 || side < 20) check(mesh, area);
        if (HasFatalFailure()) return;
      }
      check(mesh, area);
    }
}

TEST(CellMesh, LocatesAndTellsWhatHasChanged) {
  const Raster raster = test::make_grid(40, 30, [](int, int) { return 0.0F; });
  CellMesh mesh(greedy::hull_of_valid(raster));
  mesh.clear_changed();
  EXPECT_TRUE(mesh.changed().empty());
  EXPECT_EQ(mesh.insert(cell_at(0, 0), 0), kNone);  // a vertex already
  EXPECT_TRUE(mesh.changed().empty());
  const std::uint32_t v = mesh.insert(cell_at(13, 7), 0);
  ASSERT_NE(v, kNone);
  CellMesh::Star star;
  mesh.star(v, star);
  for (const std::uint32_t t : star.triangles) EXPECT_TRUE(mesh.is_changed(t));
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const std::uint32_t t = mesh.locate(cell_at(x, y), 0);
      ASSERT_NE(t, kNone);
      const auto& c = mesh.triangles()[t];
      for (std::size_t k = 0; k < 3; ++k) EXPECT_GE(turn(mesh.cell(c[k]), mesh.cell(c[(k + 1) % 3]), cell_at(x, y)), 0);
    }
  EXPECT_EQ(mesh.locate(cell_at(50, 7), 0), kNone);
  EXPECT_FALSE(mesh.remove(0));  // a corner of the outline
}

}  // namespace
}  // namespace retalho
