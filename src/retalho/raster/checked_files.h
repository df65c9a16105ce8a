// Internal to raster/, level/ and curve/. The disk as GDAL sees it, with an account: several of GDAL's drivers
// (AAIGrid, ESRI Shapefile, GeoJSON, DXF in 3.6) do not look at what a write or a close returns, and closing a dataset
// does not tell. Here every failure is remembered, whoever ignores it, and after the first one every write fails.
#pragma once

#include <string>
#include <string_view>

namespace retalho {

/// Files that a driver writes while this lives. Give it `name(path)` instead of `path`, close the dataset, then ask.
/// Any number of them in any threads. Only for drivers that write through GDAL's own files: those on SQLite (which
/// checks for itself), netCDF or HDF5 open the disk directly.
class CheckedFiles {
 public:
  CheckedFiles();
  ~CheckedFiles();
  CheckedFiles(const CheckedFiles&) = delete;
  CheckedFiles& operator=(const CheckedFiles&) = delete;

  /// `path` through this account; files beside it, with other endings, are counted too.
  std::string name(const std::string& path) const;
  /// errno of the first failure, 0 if there was none.
  int error() const;
  /// Whether a driver of this name writes through GDAL's own files.
  static bool serves(const std::string& driver);

 private:
  int account_;
};

/// A file of GDAL's in memory, gone with this object: for text drivers that crash when a write fails (DXF in 3.6).
class MemoryFile {
 public:
  /// `ending` as in ".dxf", for drivers that look at it.
  explicit MemoryFile(const std::string& ending);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& name() const { return name_; }
  std::string_view bytes() const;
  static bool serves(const std::string& driver) { return driver == "GeoJSON" || driver == "DXF"; }

 private:
  std::string name_;
};

}  // namespace retalho
