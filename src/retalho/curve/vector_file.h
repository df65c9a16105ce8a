// Lines of vector layers, read and written through GDAL: GeoPackage, GeoJSON, Shapefile, DXF and what else it knows.
#pragma once

#include <string>
#include <vector>

#include "retalho/curve/flatten.h"

namespace retalho {

struct VectorLine {
  std::string name;
  std::vector<Vec3> points;
  int dimension = 2;
  bool closed = false;  ///< a ring: the first point is not repeated
};

/// Every line and ring of every layer, in the file's order; curves of the file's own (arcs) are read as GDAL flattens
/// them. Throws CannotRead, and BadInput when there is no line.
std::vector<VectorLine> read_vector_lines(const std::string& path);

/// By the ending: .gpkg .geojson .shp .dxf. Atomic. Coordinates are written in full precision where the format keeps
/// doubles (GeoPackage, Shapefile; GeoJSON with 17 digits). Throws UsageError for another ending, CannotWrite.
void write_vector_lines(const std::vector<VectorLine>& lines, const std::string& path, bool overwrite = false);

}  // namespace retalho
