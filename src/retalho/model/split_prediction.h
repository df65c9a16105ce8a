// Where Powell-Sabin edges are expected to be split: part of format 1 (docs/model-file.md), written out here so that a
// file does not depend on how terrain/ computes the same points. Files hold the distance to this, in representable
// doubles: mostly 0. Internal to the room.
#pragma once

#include <vector>

#include "retalho/tin/tin.h"

namespace retalho {

/// For each edge in build_edges' order, from its lower-index end: where the line through the incentres of its two
/// triangles meets it; 1/2 on the border. Every operation is one of IEEE 754's exactly rounded ones, in the order of
/// the source, so every machine gets the same bits. Finite or not, never throws.
std::vector<double> predict_splits(const Tin& tin, const EdgeTable& edges);

}  // namespace retalho
