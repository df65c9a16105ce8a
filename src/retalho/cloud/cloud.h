// Points with optional normals, and the formats that they come in: text (.xyz, .csv, .txt), PLY, LAS, OBJ, and
// every vector format that GDAL opens.
//
//   .xyz .csv .txt .pts .dat .asc   white space, comma, semicolon or tab between values; '#', '%', '>' and '//' begin
//                                   a comment; a header line may name the columns (x, y, z, nx, ny, nz and the usual
//                                   synonyms), else the first three are x, y, z, and columns 4 to 6 are normals where
//                                   every line has a unit vector there
//   .ply                            ascii, binary little and big endian; the vertex element's x, y, z, nx, ny, nz
//   .las                            1.0 to 1.4, uncompressed, with its CRS; points that it withholds are left out
//   .obj                            "v" lines; normals ("vn") that faces, or an equal number, give to vertices
//   others                          points, multi-points and the vertices of lines, with their z or a numeric attribute
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"
#include "retalho/raster/georef.h"

namespace retalho {

/// Positions are double and local (raster/georef.h): CRS coordinates less the origin, in metres where the CRS is
/// geographic. The origin is 0 unless the points lie so far out (a thousand times their extent) that digits would be
/// lost; then it is a whole number near their middle, and the subtraction is exact.
struct PointCloud {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  ///< one a position, as in the file (unit length is not enforced); or empty
  Georef georef;
};

struct PointOptions {
  std::string height_field = {};  ///< vector layers: the numeric attribute with the height; empty: the geometry's z
  std::string layer = {};         ///< vector files with several layers: which one
  std::string crs = {};           ///< for formats without one: "EPSG:25832", WKT ...; empty: none
};

/// What was read and how.
struct PointNotes {
  std::string format;                ///< "text", "PLY (binary_little_endian)", "GPKG"
  std::string columns;               ///< what was taken for what: "x, y, z of 5 columns"
  std::string crs_name;              ///< as ReadNotes::crs_name
  std::size_t skipped = 0;           ///< points left out since a coordinate is missing or not finite
  std::vector<std::string> remarks;  ///< words for the user
};

/// Throws CannotRead (missing, unknown format, damaged: with the line or the vertex) and BadInput (no points, no
/// heights, a decimal comma, an unknown layer, attribute or CRS). Points whose coordinates are NaN, infinite or missing
/// are left out and counted in the notes.
PointCloud read_points(const std::string& path, const PointOptions& options = {}, PointNotes* notes = nullptr,
                       const Context& context = {});

/// Whether `path` has an ending that read_points takes for points by itself (.xyz, .csv, .txt, .pts, .ply, .las): how a
/// command that accepts grids and points tells them apart.
bool is_point_file(const std::string& path);

struct PointSummary {
  std::size_t points = 0;
  Vec3 minimum, maximum;  ///< local coordinates; NaN when there is no point
};
PointSummary summarize(const PointCloud& cloud);

/// One line for the user: how many, where, CRS, height range.
std::string describe(const PointCloud& cloud, const PointNotes& notes, const PointSummary& summary);

}  // namespace retalho
