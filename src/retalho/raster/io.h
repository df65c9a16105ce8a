// Elevation grids from files and to files: everything that GDAL opens, and ASCII PGM (P2), which it does not.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/raster/window.h"

namespace retalho {

struct ReadOptions {
  int band = 1;                       ///< 1-based
  std::optional<double> nodata = {};  ///< heights equal to this are void too, besides the file's own no-data
  /// Only these cells, counted north and west first; scales are still those of the whole grid. Not of ASCII PGM.
  std::optional<CellWindow> window = {};
};

/// What was read and how, for the line that the program prints and for `info`.
struct ReadNotes {
  std::string driver;            ///< "GTiff", "PGM (ASCII)"
  std::string data_type;         ///< "Int16", "Float32" ...
  std::optional<double> nodata;  ///< the file's no-data value, if any
  double scale = 1, offset = 0;  ///< applied to the stored values
  std::string crs_name;          ///< "EPSG:32611 WGS 84 / UTM zone 11N", or empty
  int bands = 1;
  std::size_t infinite = 0;          ///< infinite heights made void
  std::vector<std::string> remarks;  ///< words for the user: "geographic CRS: distances are metres at latitude 48.5"
};

/// Reads one band. Rows come north first and columns west first, whatever the file's order. `path` may be anything
/// that GDALOpen takes (a file, a /vsi path, a VRT as text) or a P2 PGM (optionally gzip-free plain text).
/// Memory: 4 bytes a cell (8 where float would not be exact) and one block row. Checks the claimed size against the
/// memory there is before it allocates.
/// Throws CannotRead (missing, unknown format, truncated), BadInput (rotated or sheared geotransform, zero cell size,
/// complex data, no such band, absurd size).
Raster read_raster(const std::string& path, const ReadOptions& options = {}, ReadNotes* notes = nullptr,
                   const Context& context = {});

/// Where the grid lies and how many cells it has; no heights are read. Throws as read_raster, and BadInput for ASCII
/// PGM, of which no part can be read.
Raster inspect_raster(const std::string& path, const ReadOptions& options = {});

/// One line for the user: size, cell size and units, CRS, valid cells, range.
/// "344 x 403 cells of 76.2 x 92.5 metre, EPSG:4326 WGS 84, 138632 valid (100 %), heights 231 to 1077"
std::string describe(const Raster& raster, const ReadNotes& notes, const RasterSummary& summary);

struct WriteOptions {
  std::string driver = {};  ///< GDAL short name; empty: by the file's extension (.tif, .asc, .img ...)
  /// As GDAL's -co; empty: sensible ones for GeoTIFF (DEFLATE, predictor, tiles).
  std::vector<std::string> creation_options = {};
  bool overwrite = false;
};

/// Writes one float (or double) band with CRS, geotransform and no-data, atomically. Void cells become NaN where the
/// driver can, else -9999. Throws CannotWrite.
void write_raster(const Raster& raster, const std::string& path, const WriteOptions& options = {},
                  const Context& context = {});

/// Can the driver of this name take rows one after another, with NaN for no data?
bool takes_rows(const std::string& path, const WriteOptions& options = {});

/// The same raster as write_raster of one of floats, of which `rows(first, count, out)` gives some rows at a time,
/// from north to south, each once; `place`: everything but the heights. Memory: 256 rows. Throws as write_raster, and
/// UsageError where takes_rows is false.
void write_rows(const Raster& place, const std::string& path, const WriteOptions& options,
                const std::function<void(int first, int count, std::span<float> out)>& rows,
                const Context& context = {});

}  // namespace retalho
