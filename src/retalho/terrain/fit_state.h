// A surface in the making on an editable triangulation of cells: the mesh, what its vertices store, and what its
// triangles add to the least-squares problem. Internal to terrain/.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/terrain/fit_system.h"
#include "retalho/tin/cell_mesh.h"

namespace retalho {
/// The corners of the box of the valid cells. They are vertices even where they are void: the slivers along the
/// slanting sides of a hull would spoil the surface there. Throws as hull_of_valid.
std::vector<greedy::Cell> box_of_valid(const Raster& raster);

struct FitState {
  SurfaceKind kind;
  FitGrid grid;
  CellMesh mesh;
  std::vector<Vec3> data;            ///< of each vertex, units of the fit
  std::vector<std::uint8_t> pinned;  ///< of each vertex: kHeldHeight: its height is its cell's
  std::vector<std::uint8_t> folded;  ///< of each vertex: 1 where it is (folds.h); empty: none; Clough-Tocher only
  double gradient_price = 0;         ///< what the objective counts for each vertex that is not folded
  std::vector<FitElement> elements;  ///< of each triangle, up to date after refresh()
  std::vector<float> cell_weights;   ///< empty: 1
  FitWeights weights;
  /// Of the grid's sides (north, west, south, east): vertices on them stay, and no others come onto them.
  std::array<bool, 4> frozen{};

  /// On the corners of the box of the valid cells.
  FitState(const Raster& raster, SurfaceKind kind, const Context& context);
  /// On a triangulation with the heights of its cells.
  FitState(const Raster& raster, SurfaceKind kind, CellMesh on, const Context& context);

  /// The triangle as it is, or with vertex `moved` at cell coordinates `to`.
  FitTriangle triangle(std::uint32_t t, std::uint32_t moved = kNone, Vec2 to = {}) const;
  /// What the surface has at the corners, folds included.
  CornerData corner_data(std::uint32_t t) const;
  bool is_folded(std::uint32_t vertex) const { return !folded.empty() && folded[vertex] != 0; }
  bool on_frozen(CellMesh::Cell cell) const {
    const int column = greedy::column_of(cell), row = greedy::row_of(cell);
    return (frozen[0] && row == 0) || (frozen[1] && column == 0) || (frozen[2] && row == grid.rows - 1) ||
           (frozen[3] && column == grid.columns - 1);
  }
  double height(CellMesh::Cell cell) const { return grid.z[grid.cell(greedy::column_of(cell), greedy::row_of(cell))]; }

  /// Elements of the triangles that have changed since the last time; all of them where `all`.
  void refresh(const Context& context, bool all = false);
  /// Solves for all vertices from where they are.
  int solve(const CgLimits& limits, const Context& context);
  /// Where vertices may be folded: a gradient counts what one more number would save, as RMSE falls by about the power
  /// 3/4 of the numbers. One, not two: which vertices are folded is to be written too, and predictions beside them are
  /// worse.
  void set_gradient_price();
  /// The objective, with the price of the gradients.
  double cost(const Context& context) const;
  std::vector<double> costs(const Context& context) const;

  /// Height and gradient of the surface at a cell of triangle `t`, units of the fit.
  Vec3 surface_at(std::uint32_t t, CellMesh::Cell cell) const;
  /// A new vertex with the data of the surface there; false where there is none to be had.
  bool insert(CellMesh::Cell cell, std::uint32_t t, Vec3 at);
  bool remove(std::uint32_t vertex);
};

/// What can be put back. The elements, most of a state's bytes, are not kept: they follow from the rest.
struct FitSnapshot {
  CellMesh mesh;
  std::vector<Vec3> data;
  std::vector<std::uint8_t> pinned, folded;

  explicit FitSnapshot(const FitState& s) : mesh(s.mesh), data(s.data), pinned(s.pinned), folded(s.folded) {}
  void restore(FitState& s, const Context& context) const {
    s.mesh = mesh;
    s.data = data;
    s.pinned = pinned;
    s.folded = folded;
    s.refresh(context, true);
  }
};

/// The terrain that the state is. `creases`: pairs of vertices; then further sectors start as the vertices' own.
Terrain to_terrain(const FitState& state, const Raster& raster, const Context& context,
                   std::span<const std::array<std::uint32_t, 2>> creases = {});

}  // namespace retalho
