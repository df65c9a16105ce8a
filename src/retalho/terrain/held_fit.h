// A surface's fit to its grid that goes on while some of its numbers are already settled: what a coder needs that
// rounds one number after another and lets the rest make up for it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tin/grid_cell.h"

namespace retalho {

struct HeldFitOptions {
  SurfaceKind surface = SurfaceKind::clough_tocher;  ///< linear or clough_tocher
  bool heights_only = false;  ///< gradients follow the heights as GradientKind::normals; clough_tocher only
  double slope_weight = 0;    ///< as in LeastSquaresOptions
  double fairness = 1e-4;
};

/// Least squares as in least_squares.h on the canonical Delaunay triangulation of `vertices`, with a weight for every
/// cell. Vertices are numbered as given. Heights are the grid's; gradients are height units per side of a cell (of its
/// area's square root where it is not square). The same from any number of threads.
class HeldFit {
 public:
  /// `vertices`: valid or void cells of the grid, ascending, at least three not on one line. Throws BadInput otherwise.
  /// `folded`: 1 for each vertex that is folded (folded_surface.h), Clough-Tocher only; empty: none.
  HeldFit(const Raster& raster, std::span<const greedy::Cell> vertices, const HeldFitOptions& options,
          const Context& context = {}, std::span<const std::uint8_t> folded = {});
  ~HeldFit();
  HeldFit(HeldFit&&) noexcept;
  HeldFit& operator=(HeldFit&&) noexcept;

  double height(std::uint32_t vertex) const;
  Vec2 gradient(std::uint32_t vertex) const;
  bool is_folded(std::uint32_t vertex) const;

  void set(std::uint32_t vertex, double height, Vec2 gradient);
  /// From now on the number is this one.
  void hold_height(std::uint32_t vertex, double height);
  void hold_gradient(std::uint32_t vertex, Vec2 gradient);
  /// Nothing (of this vertex) is held any more; numbers stay where they are.
  void release();
  void release(std::uint32_t vertex);

  /// Solves for all that is not held, from where it is, until the residual has fallen by `tolerance`.
  void solve(double tolerance, int iterations = 1000);

  /// Weights of the cells, row by row. Empty (as at the start): 1 each.
  const std::vector<float>& cell_weights() const;
  void set_cell_weights(std::vector<float> weights);
  /// Lawson's rule: cells near `tolerance` or over it count more from now on. False where none is over it.
  bool reweigh(double tolerance);

  /// Surface minus height at every cell; NaN where it is void.
  std::vector<double> errors() const;
  /// Of the cells of a vertex's triangles, in units of the tolerance.
  struct StarErrors {
    double excess = 0;   ///< sum of (|S - z| - 1)^2 over the cells that are over it
    double squares = 0;  ///< sum of (S - z)^2
  };
  /// If the vertex had these numbers. Not for heights_only.
  StarErrors star_errors(std::uint32_t vertex, double height, Vec2 gradient, double tolerance) const;
  /// If the vertex were folded, with this height. Clough-Tocher with `folded` only.
  StarErrors star_errors_folded(std::uint32_t vertex, double height, double tolerance) const;
  /// Folds it. solve() must not be called any more.
  void fold(std::uint32_t vertex, double height);
  /// Vertices of the triangles with an error over `tolerance`, ascending.
  std::vector<std::uint32_t> vertices_over(double tolerance) const;
  /// Neighbours of a vertex.
  std::vector<std::uint32_t> neighbors(std::uint32_t vertex) const;
  /// Of each triangle of the triangulation with an error over `tolerance`: the cell with the largest, if it is no
  /// vertex; no two of triangles that touch, the largest errors first.
  std::vector<greedy::Cell> worst_cells(double tolerance) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace retalho
