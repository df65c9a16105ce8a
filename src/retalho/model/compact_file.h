// The compact form of a model file: a header, then one range-coded stream (docs/compact-file.md). What it holds is a
// terrain whose numbers have been rounded; what is read is what the writer got, to the last bit. Internal to the room.
//
//   offset  bytes
//        0      4  signature 89 52 54 43 (\x89RTC)
//        4      1  version: 1; 2 where vertices are folded
//        5      4  the low half of XXH64 (seed 0) of everything else: bytes 0 to 4, then 9 to the end
//        9         size of what follows (varint), header, stream
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/model/compact_values.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

inline constexpr int kCompactVersion = 2;

bool has_compact_signature(std::string_view bytes);

/// What a compact file says beside its vertices.
struct CompactFrameFacts {
  SurfaceKind kind = SurfaceKind::clough_tocher;  ///< linear or clough_tocher
  bool heights_only = false;                      ///< clough_tocher: gradients are the facets' means
  Georef georef;
  GridDomain grid;
  double tolerance = 0;
  double reference = 0;  ///< about the mean height
  CompactSteps steps;
};

struct CompactEncoding {
  std::string bytes;
  Terrain terrain;  ///< as decode_compact reads it
};

/// Writes the vertices at these cells (ascending, three or more not on one line) with the numbers of `source`.
/// `folded`: 1 for each that is (terrain/folded_surface.h; Clough-Tocher with gradients of its own), empty: none.
/// Throws BadInput for what the format does not hold: sides over 65,535 or 2^28 cells, other kinds, steps that are no
/// positive numbers, heights beyond 2^29 steps.
CompactEncoding encode_compact(const CompactFrameFacts& facts, const std::vector<greedy::Cell>& cells,
                               ValueSource& source, const Context& context = {},
                               const std::vector<std::uint8_t>& folded = {});

/// Throws CannotRead for anything that encode_compact did not write: every proper prefix, every changed byte (by the
/// checksum), and what got past the checksum and is no terrain without a fault. Time and memory are bounded by the
/// grid's size (0.3 us and half a byte a cell) and the file's (256 vertices a byte).
Terrain decode_compact(std::string_view bytes);

}  // namespace retalho
