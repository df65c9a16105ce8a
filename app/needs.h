// What each command's work needs of memory, by its input: refused before it starts where the limit is less. The numbers
// are measured (docs/limits.md, tests/faults/limits.py) and a little above what was seen. What depends on the result
// (vertices to a tolerance, vertices of level lines) is not known before; for that there is the watch of work_limits.h.
#pragma once

#include <cstddef>
#include <string>

#include "retalho/terrain/terrain.h"

namespace retalho::app {

/// Beside the process itself and what reading takes for each cell (4 to 12 bytes).
struct Need {
  std::string work = "reading";
  double a_cell = 0;    ///< bytes a cell of the input grid
  double more = 0;      ///< bytes that do not depend on it: vertices of a budget, an output
  double a_column = 0;  ///< bytes a column, where a strip of rows is held at a time
};

/// Throws BadInput where a grid of this size needs more than the limit. Says nothing of a file that the reader will
/// refuse, or that can be read only once.
void check_grid_need(const Need& need, const std::string& file, int band);
/// The same for files whose content is in proportion to their bytes (points, meshes, models).
void check_file_need(const std::string& work, double bytes_a_byte, const std::string& file);
/// The same for work on a terrain in memory: bytes a vertex, the model's own included, and more.
void check_terrain_need(const std::string& work, const Terrain& terrain, double a_vertex, double more,
                        const std::string& file);
void check_vertex_need(const std::string& work, std::size_t vertices, double a_vertex, double more,
                       const std::string& file);

// Bytes.
inline constexpr double kVertexFitted = 300;  ///< fit: triangulation, surface, file in memory
inline constexpr double kPointFitted = 750;   ///< fit of points: the same, and the triangulation of scattered points
inline constexpr double kVertexLeastSquares = 2000;  ///< the normal equations and their factor
inline constexpr double kCellContoured = 64;         ///< the whole bicubic surface; lines come on top
/// contour without it: the rows of a strip and those around it, for each strip under way; lines that go on come on top.
inline constexpr double kColumnStreamed = 130 * 70;
inline constexpr double kVertexMeshed = 700;  ///< mesh: the coarsest mesh; finer ones are not known before
inline constexpr double kVertexLoaded = 500;  ///< a terrain and its evaluator
inline constexpr double kCellSampled = 28;    ///< double, float, gradient
inline constexpr double kCellSeen = 12;       ///< counts, map, output
inline constexpr double kCellIntervisible = 24;
inline constexpr double kCellCompared = 40;  ///< compare --visibility
inline constexpr double kPointFile = 6;      ///< a byte of a file of points
inline constexpr double kModelFile = 20;     ///< a byte of a model file

}  // namespace retalho::app
