// TetraQuads written by hand: quadrics at the vertices of a few tetrahedra, as JSON (docs/tetraquad.md has the form).
#pragma once

#include <string>

#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// Throws CannotRead (missing, no JSON: with the place) and BadInput (a key missing, unknown or of the wrong kind, a
/// tetrahedron or a vertex that does not exist, a vertex without a quadric), naming the key.
TetraQuad read_quadrics(const std::string& path);
/// The same from the text itself; `file` is its name in messages.
TetraQuad parse_quadrics(const std::string& text, const std::string& file = {});

}  // namespace retalho
