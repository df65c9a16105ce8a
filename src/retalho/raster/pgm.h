// P2, the ASCII form of PGM, which GDAL does not read: samples in row order, top row first, '#' comments anywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"

namespace retalho {

/// Fills a buffer of `size` bytes and returns how many it wrote; 0 at the end.
using ByteSource = std::function<std::size_t(char* buffer, std::size_t size)>;

/// Reads one P2 image: any maxval up to 2^53, any white space, LF or CRLF, comments between any two numbers. Cells are
/// 1 unit wide, the first cell's centre is the origin. Nothing may follow the last sample but white space and comments.
/// Throws CannotRead with the line (and the sample's column and row) for anything else: a cut file, a sign or a letter
/// where a number should be, a sample above maxval, more samples than `size` bytes (of the source, where that is known)
/// can hold; BadInput for more cells than memory holds.
Raster read_pgm(const ByteSource& source, const std::string& name, const Context& context = {},
                std::optional<std::uint64_t> size = {});

}  // namespace retalho
