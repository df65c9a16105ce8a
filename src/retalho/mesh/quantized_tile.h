// One tile of quantized-mesh 1.0 as bytes. Internal to mesh/.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "retalho/core/vec.h"

namespace retalho {

inline constexpr int kQuantizedMost = 32767;  ///< u, v and heights run from 0 to this

struct QuantizedVertex {
  std::uint16_t u = 0, v = 0;  ///< from west, from south
  std::uint16_t height = 0;    ///< steps over the tile's lowest height
  Vec3 normal;                 ///< unit, earth-centred
};

struct QuantizedTile {
  double west = 0, south = 0, size = 0;  ///< degrees
  double lowest = 0, step = 1;           ///< heights; lowest + 32767 step must be a float
  std::vector<QuantizedVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from above
};

/// Vertices are put into the order of their first use, as the high water mark asks.
std::string encode_tile(QuantizedTile tile, bool normals);

/// Two bytes, x first, that say a unit vector (Cigolle et al. 2014).
std::array<std::uint8_t, 2> oct_encode(Vec3 normal);

/// gzip (RFC 1952) without a time, so that the same bytes give the same bytes.
std::string gzip(const std::string& bytes);

}  // namespace retalho
