// Contour lines and bands as vector layers, through GDAL: GeoPackage, GeoJSON, Shapefile, DXF by the file's ending.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/contours.h"
#include "retalho/raster/georef.h"

namespace retalho {

struct VectorOptions {
  bool overwrite = false;
  int index_every = 5;    ///< every so many levels, counted from `index_base`, a line is an index contour; 0: none
  double index_base = 0;  ///< a level that is an index contour
  double interval = 0;    ///< between levels; 0: levels are counted by their place in the list
};

/// Is this level an index contour?
bool is_index_level(const std::vector<double>& levels, int level, const VectorOptions& options);

/// One feature a line, with the attributes elev (height), index (1: index contour) and closed (1: a ring); high ground
/// lies to the left of every line. The layer carries the CRS; DXF has heights as z, and the layers "contour" and
/// "contour_index" instead of attributes. No lines: a layer without features. The file is complete or absent, and so
/// are the parts of a Shapefile. Throws CannotWrite.
void write_contours(const ContourSet& set, const Georef& georef, const std::string& path,
                    const VectorOptions& options = {}, const Context& context = {});

/// The same of lines that come one set after the other: `trace` is called once, and calls what it is given with each.
/// GeoPackage and Shapefile hold no more than the lines of one set; GeoJSON and DXF are put together in memory first.
void write_contours(const Georef& georef, const std::string& path, const VectorOptions& options, const Context& context,
                    const std::function<void(const TakeContours& take)>& trace);

/// One polygon with holes a region, with the attributes band (0: below the first level), elev_min and elev_max (missing
/// where the band is open to that side). Not as DXF.
void write_bands(const BandSet& bands, const Georef& georef, const std::string& path, const VectorOptions& options = {},
                 const Context& context = {});

}  // namespace retalho
