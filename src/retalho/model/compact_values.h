// Heights and gradients of a compact model: level by level, predicted from the surface of the coarser levels, rounded
// to steps, coded by how well the neighbours were predicted (docs/compact-file.md). Internal to the room.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/model/bit_coder.h"
#include "retalho/model/compact_levels.h"
#include "retalho/model/thin_plate.h"

namespace retalho {

/// How finely the numbers of a compact model are kept.
struct CompactSteps {
  double height = 1;          ///< of a vertex that stands for one cell, > 0
  std::uint8_t crowding = 6;  ///< one that stands for n cells (a third of its triangles) has n^-(crowding / 16) of it
  std::uint8_t slope = 16;    ///< quarters: a gradient's step times the root of n, in steps of its height
};

/// Where the writer's numbers come from. The numbers that have been coded are told to it, so that it may make the best
/// of the others.
class ValueSource {
 public:
  virtual ~ValueSource() = default;
  /// Called before each group of numbers.
  virtual void settle() = 0;
  virtual double height(std::uint32_t vertex) = 0;
  virtual Vec2 gradient(std::uint32_t vertex) = 0;
  /// May the number be this one instead, which takes fewer bits?
  virtual bool accepts_height(std::uint32_t, double) { return false; }
  virtual bool accepts_gradient(std::uint32_t, Vec2) { return false; }
  virtual void coded_height(std::uint32_t vertex, double height) = 0;
  virtual void coded_gradient(std::uint32_t vertex, Vec2 gradient) = 0;
};

/// The frame in which numbers are predicted.
struct CompactFrame {
  std::span<const greedy::Cell> cells;  ///< ascending
  std::span<const CellLevel> levels;
  std::span<const std::uint8_t> folded;  ///< 1: the vertex has no gradient (terrain/folded_surface.h); empty: none
  Vec2 step;                             ///< of a cell, step.x * step.y = 1
  double reference = 0;                  ///< about the mean height
};

/// The steps of every vertex's height and gradient: they follow from the positions.
struct LatticeSteps {
  std::vector<double> height, slope;
  /// On its lattice, the number next to this one.
  static double nearest(double value, double step);
};
LatticeSteps lattice_steps(const CellTriangulation& finest, const CompactSteps& steps);

/// Codes heights (and gradients) of all vertices, by their place among the cells. `source` when writing, null when
/// reading. Gradients: height units per side of a cell. Returns exactly what a reader of the same bits gets.
/// Cost: about 20 us a vertex.
std::vector<VertexJet> code_values(BitCoder& coder, const CompactFrame& frame, const CompactSteps& steps,
                                   bool gradients, ValueSource* source, const Context& context = {});

}  // namespace retalho
