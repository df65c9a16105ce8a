// The two estimates that have a file of their own, and what they share. Use gradients.h from outside.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tin/tin.h"

namespace retalho {

/// The neighbours of each vertex, in the order of the edges' numbers.
struct VertexRings {
  std::vector<std::uint32_t> begin, neighbors;
};
VertexRings build_rings(const Tin& tin, const EdgeTable& edges);

std::vector<Vec2> quadratic_gradients(const Tin& tin, const VertexRings& rings, const Context& context);
std::vector<Vec2> network_gradients(const Tin& tin, const VertexRings& rings, const Context& context);

}  // namespace retalho
