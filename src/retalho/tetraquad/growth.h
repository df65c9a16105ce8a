// Tetrahedra added where a fitted surface leaves those that there are. Internal to the room.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tetraquad/energy.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// Border half-faces that the surface meets: the function changes its sign on a lattice of six parts a side.
std::vector<std::uint32_t> open_faces(const TetraQuad& surface, const HalfFaces& faces);

/// Adds the tetrahedra beyond those faces whose cell is within `reach` cells of one of `data` (ascending). The new
/// vertices' quadrics minimise the smoothing terms of the energy, the others stay. Returns how many were added.
std::size_t grow_once(TetraQuad& surface, HalfFaces& faces, const std::vector<LatticePoint>& data, int reach,
                      const EnergyWeights& weights, const Context& context);

}  // namespace retalho
