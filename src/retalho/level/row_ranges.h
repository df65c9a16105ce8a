// Internal to level/: which patches of a row of a fixed-point grid may hold a level; most are sorted out here, and with
// them their edges.
#pragma once

#include <cstddef>
#include <cstdint>

#include "retalho/level/fixed_levels.h"

namespace retalho {

/// The range of the ordinates of n patches: nodes of a row and of the row after it, which starts `width` later.
void bound_patch_row(const std::int32_t* z, const std::int32_t* u, const std::int32_t* v, const std::int32_t* t,
                     std::size_t width, std::size_t n, std::int32_t* low, std::int32_t* high);
/// The places of n whose doubled range `levels` may cross, ascending, into `places` (room for n); how many. `marked`:
/// room for n bytes.
std::size_t select_ranges(const std::int32_t* low, const std::int32_t* high, std::size_t n, const FixedLevels& levels,
                          std::uint8_t* marked, std::uint32_t* places);

}  // namespace retalho
