// A CRS in four bytes instead of a kilobyte, where its code says the same.
#pragma once

#include <string>

namespace retalho {

/// The EPSG code whose CRS, as this GDAL and PROJ write it, is this WKT to the letter; 0: none.
int epsg_of(const std::string& wkt);
/// The EPSG code that this WKT itself names, whether or not it says all that the code does; 0: none.
int epsg_named_by(const std::string& wkt);
/// The WKT of an EPSG code. Throws BadInput where PROJ knows no such code.
std::string wkt_of_epsg(int code);

}  // namespace retalho
