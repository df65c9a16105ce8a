// Tetrahedra added where a fitted surface leaves those that there are. Internal to the room.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tetraquad/closing.h"
#include "retalho/tetraquad/energy.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// The same surface on another mesh: vertices at the same lattice points keep their quadrics, others get zeros and are
/// marked.
TetraQuad moved_to(const TetraQuad& surface, TetMesh mesh, std::vector<char>* is_new);

/// The leaf of each tetrahedron of an adaptive mesh.
std::vector<std::uint32_t> leaves_of(const TetMesh& mesh);

/// The marked vertices' quadrics minimise the energy's smoothing terms together, the others stay.
void solve_new(TetraQuad& surface, const HalfFaces& faces, const std::vector<char>& is_new,
               const EnergyWeights& weights, const Context& context);

/// `seeds` (one mark a tetrahedron) and all that the surface reaches from them across faces.
std::vector<char> hanging_together(const TetraQuadField& field, const HalfFaces& faces, std::vector<char> seeds);

/// Drops tetrahedra whose piece of the surface hangs together with none in a tetrahedron of `with_points` (ascending):
/// sheets that no point asks for. Returns how many.
std::size_t drop_stray(TetraQuad& surface, HalfFaces& faces, const std::vector<TetPlace>& with_points);

/// Border half-faces that the surface meets: the function changes its sign on a lattice of six parts a side.
std::vector<std::uint32_t> open_faces(const TetraQuad& surface, const HalfFaces& faces);

/// Finds the quadrics of the marked vertices, as solve_new does.
using Fill = std::function<void(TetraQuad& surface, const HalfFaces& faces, const std::vector<char>& is_new)>;

/// Closes holes: adds all tetrahedra of the cubes round those faces, as long as a cube is within `reach` cubes of one
/// of `data` (ascending; with a guide: anywhere in its box), at most `rounds` times. All that has been added is filled
/// together, the rest stays. In the end only what closes a hole is kept. Returns the number of rounds.
int grow(TetraQuad& surface, HalfFaces& faces, const std::vector<LatticePoint>& data, int reach, int rounds,
         const Fill& fill, const ClosedGuide* guide, const Context& context);

}  // namespace retalho
