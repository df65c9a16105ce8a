// Is a model one that the rest of the house may use without a doubt? Asked of every model before it is written and
// after it is read. Internal to the room.
#pragma once

#include <cstddef>
#include <string>

#include "retalho/patch/patch.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// Inner and border edges of a TIN with correct neighbours: the length of build_edges' table, without building it.
std::size_t edge_count(const Tin& tin);

/// What is wrong with `terrain`, in words; empty: nothing. Asks for finite numbers, at least one triangle, vertex
/// indices in range, triangles counter-clockwise (exactly) with neighbours as build_neighbors finds them, and arrays as
/// long as the surface kind says. It does not ask whether far triangles overlap. Throws BadInput where build_neighbors
/// does.
/// `neighbors_built`: build_neighbors has just made the neighbours, they need no look.
std::string find_fault(const Terrain& terrain, bool neighbors_built = false);

/// The same for a TetraQuad: finite numbers, a positive step, at least one tetrahedron, one quadric a vertex, and the
/// mesh that its `places` make.
std::string find_fault(const TetraQuad& surface);

/// The same for patches: finite numbers, parameters in the parameter triangle that its triangles cover once (by area),
/// sides that run from corner to corner along their nodes, and curves that can be evaluated and pass through the nodes
/// to 1e-6 of the size.
std::string find_fault(const PatchSet& set);

}  // namespace retalho
