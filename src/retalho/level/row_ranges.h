// Internal to level/: which edges and patches of a row of a fixed-point grid may hold a level; most are sorted out
// here.
#pragma once

#include <cstddef>
#include <cstdint>

#include "retalho/level/fixed_levels.h"

namespace retalho {

/// The range of the ordinates of n edges: from node c to node c + step, with tangents d.
void bound_edge_row(const std::int32_t* z, const std::int32_t* d, std::size_t step, std::size_t n, std::int32_t* low,
                    std::int32_t* high);
/// The range of the ordinates of n patches: nodes of a row and of the row after it, which starts `width` later.
void bound_patch_row(const std::int32_t* z, const std::int32_t* u, const std::int32_t* v, const std::int32_t* t,
                     std::size_t width, std::size_t n, std::int32_t* low, std::int32_t* high);
/// marked[c]: 1 where levels.may_cross the doubled range.
void mark_ranges(const std::int32_t* low, const std::int32_t* high, std::size_t n, const FixedLevels& levels,
                 std::uint8_t* marked);

}  // namespace retalho
