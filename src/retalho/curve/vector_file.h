// Lines of vector layers, read and written through GDAL: GeoPackage, GeoJSON, Shapefile, DXF and what else it knows.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/curve/flatten.h"

namespace retalho {

struct VectorLine {
  std::string name;
  std::vector<Vec3> points;
  int dimension = 2;
  bool closed = false;  ///< a ring: the first point is not repeated
};

/// Every line and ring of every layer, in the file's order; curves of the file's own (arcs) are read as GDAL flattens
/// them; z is 0 where the geometry has none (dimension 2). Throws CannotRead (missing, unknown, damaged), and BadInput
/// when there is no line.
std::vector<VectorLine> read_vector_lines(const std::string& path);

struct LineLayer {
  std::vector<VectorLine> lines;
  std::string crs_wkt;     ///< empty: none
  std::size_t others = 0;  ///< geometries that are neither lines nor polygons, left out
};

/// The same of one layer; `layer` empty: the only one. Throws also BadInput for no such layer or several; `option` is
/// how the user names a layer.
LineLayer read_line_layer(const std::string& path, const std::string& layer, const char* option,
                          const Context& context = {});

/// By the ending: .gpkg .geojson .shp .dxf. Atomic. Coordinates are written in full precision where the format keeps
/// doubles (GeoPackage, Shapefile; GeoJSON with 17 digits). Throws UsageError for another ending, CannotWrite.
void write_vector_lines(const std::vector<VectorLine>& lines, const std::string& path, bool overwrite = false);

}  // namespace retalho
