#include "retalho/cloud/cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <new>

#include "retalho/cloud/formats.h"
#include "retalho/core/error.h"
#include "retalho/raster/gdal.h"

namespace retalho {
namespace {

std::string ending(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_text(const std::string& extension) {
  for (const char* known : {".xyz", ".csv", ".txt", ".pts", ".dat"})
    if (extension == known) return true;
  return false;
}

/// A whole number near the middle if the points lie so far out that differences of coordinates lose digits.
double choose_origin(double low, double high) {
  const double far = std::max(std::abs(low), std::abs(high)), extent = high - low;
  return far > 1000 * extent && far >= 1000 ? std::round(0.5 * low + 0.5 * high) : 0.0;
}

void move_to_origin(PointCloud& cloud) {
  const PointSummary s = summarize(cloud);
  Georef& g = cloud.georef;
  g.origin_x = g.geographic ? 0.5 * (s.minimum.x + s.maximum.x) : choose_origin(s.minimum.x, s.maximum.x);
  g.origin_y = g.geographic ? 0.5 * (s.minimum.y + s.maximum.y) : choose_origin(s.minimum.y, s.maximum.y);
  if (g.origin_x == 0 && g.origin_y == 0 && g.scale_x == 1 && g.scale_y == 1) return;
  for (Vec3& p : cloud.positions) {
    const Vec2 local = g.to_local({p.x, p.y});
    p = {local.x, local.y, p.z};
  }
}

}  // namespace

bool is_point_file(const std::string& path) {
  const std::string extension = ending(path);
  return extension == ".ply" || extension == ".las" || extension == ".laz" || is_text(extension);
}

PointCloud read_points(const std::string& path, const PointOptions& options, PointNotes* notes,
                       const Context& context) {
  PointNotes own;
  PointNotes& into = notes ? *notes : own;
  into = {};
  PointCloud cloud;
  std::string crs = options.crs;
  const std::string extension = ending(path);
  try {
    if (extension == ".ply") {
      read_ply_points(path, cloud, into, context);
    } else if (is_text(extension)) {
      read_text_points(path, cloud, into, context);
    } else if (extension == ".obj") {
      read_obj_points(path, cloud, into, context);
    } else if (extension == ".las" || extension == ".laz") {
      std::string own_crs;
      read_las_points(path, cloud, into, own_crs, context);
      if (crs.empty()) crs = own_crs;
    } else {
      std::string own_crs;
      read_vector_points(path, options, cloud, into, own_crs, context);
      if (!own_crs.empty()) crs = own_crs;
    }
  } catch (const std::bad_alloc&) {
    throw BadInput(fmt::format("'{}' does not fit into memory", path), path);
  }
  if (cloud.positions.empty())
    throw BadInput(fmt::format("'{}' holds no point with finite coordinates ({} were left out)", path, into.skipped),
                   path);
  const PointSummary summary = summarize(cloud);
  if (!crs.empty())
    into.crs_name = describe_crs_text(crs, 0.5 * (summary.minimum.y + summary.maximum.y), cloud.georef, into.remarks);
  move_to_origin(cloud);
  return cloud;
}

PointSummary summarize(const PointCloud& cloud) {
  PointSummary s;
  s.points = cloud.positions.size();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  s.minimum = s.maximum = cloud.positions.empty() ? Vec3{kNaN, kNaN, kNaN} : cloud.positions.front();
  for (const Vec3& p : cloud.positions) {
    s.minimum = {std::min(s.minimum.x, p.x), std::min(s.minimum.y, p.y), std::min(s.minimum.z, p.z)};
    s.maximum = {std::max(s.maximum.x, p.x), std::max(s.maximum.y, p.y), std::max(s.maximum.z, p.z)};
  }
  return s;
}

std::string describe(const PointCloud& cloud, const PointNotes& notes, const PointSummary& s) {
  const Vec2 low = cloud.georef.to_crs({s.minimum.x, s.minimum.y}),
             high = cloud.georef.to_crs({s.maximum.x, s.maximum.y});
  return fmt::format("{} points{}{}, x {:.9g} to {:.9g}, y {:.9g} to {:.9g}, z {:.6g} to {:.6g}, {}", s.points,
                     cloud.normals.empty() ? "" : " with normals",
                     notes.skipped ? fmt::format(" ({} left out: not finite)", notes.skipped) : "", low.x, high.x,
                     low.y, high.y, s.minimum.z, s.maximum.z, notes.crs_name.empty() ? "no CRS" : notes.crs_name);
}

}  // namespace retalho
