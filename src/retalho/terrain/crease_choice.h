// Which edges of a surface in the making are to be creases: those that save more of the objective a number than further
// vertices would. Internal to terrain/.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "retalho/terrain/fit_state.h"

namespace retalho {

struct CreaseChoice {
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< pairs of the state's vertices
  std::size_t numbers = 0;                          ///< more than without them: one a crease, two a further sector
  double cost = 0;                                  ///< the objective, solved with them
};

/// Greedy, in rounds. A vertex without creases may get two at once, which part its star in two; one that has some may
/// get another, so that they grow into chains. What it saves is found by solving for the vertex's own height and
/// gradients with all else held. A round takes the best a number, none beside another, each at `price` of the objective
/// a number or more, up to `numbers` in all; then everything is solved for. The same from any number of threads.
/// Cost: some 50 us a vertex and round, and a solve.
CreaseChoice choose_creases(const FitState& state, std::size_t numbers, double price, const Context& context);

/// Of a state that is solved. Creases in place of vertices: as many of those whose stars cost least go as the creases'
/// numbers make up for. Where that does not lower the objective, the state stays as it is and there is no crease.
CreaseChoice trade_for_creases(FitState& state, const Context& context);

}  // namespace retalho
