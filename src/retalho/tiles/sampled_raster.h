// A tiled model's surface on a raster, made as it is written: neither the surface nor the raster is ever held.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "retalho/core/context.h"
#include "retalho/raster/io.h"
#include "retalho/tiles/reader.h"

namespace retalho {

/// What a raster's cells hold: heights; slope and aspect in degrees; the mean curvature, 1 / local unit.
enum class SampledQuantity : std::uint8_t { height, slope, aspect, curvature };

/// A raster and where its cells lie in the model's local coordinates: (c, r) at origin + (c step.x, -r step.y).
struct SampledRaster {
  Raster place;  ///< everything but the heights
  Vec2 origin, step;
};

/// Writes single-precision values, NaN where there is no data. Returns how many cells have data. Memory: some hundred
/// rows and the reader's bound. Throws UsageError where takes_rows() is false, CannotRead, CannotWrite.
std::size_t write_sampled(TileReader& reader, const SampledRaster& raster, SampledQuantity what,
                          const std::string& path, const WriteOptions& options = {}, const Context& context = {});

}  // namespace retalho
