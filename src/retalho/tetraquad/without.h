// A surface without some of its tetrahedra.
#pragma once

#include <vector>

#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// The same function on the tetrahedra that are not marked (`left_out`: one mark a tetrahedron), and their vertices.
/// Where the surface passes from one that stays into one that does not, it is open. `report`: its sizes are those that
/// remain, where it is not null.
TetraQuad without_tetrahedra(const TetraQuad& surface, const std::vector<char>& left_out,
                             TetraQuadFitReport* report = nullptr);

}  // namespace retalho
