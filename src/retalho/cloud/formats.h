// The readers behind read_points: each fills positions in the file's own coordinates. Internal to cloud/.
#pragma once

#include <string>

#include "retalho/cloud/cloud.h"

namespace retalho {

void read_text_points(const std::string& path, PointCloud& cloud, PointNotes& notes, const Context& context);
void read_ply_points(const std::string& path, PointCloud& cloud, PointNotes& notes, const Context& context);
void read_obj_points(const std::string& path, PointCloud& cloud, PointNotes& notes, const Context& context);
/// Also fills `crs` with the file's own: WKT or "EPSG:n" (empty: none).
void read_las_points(const std::string& path, PointCloud& cloud, PointNotes& notes, std::string& crs,
                     const Context& context);

/// Also fills `crs_wkt` with the layer's CRS (empty: none).
void read_vector_points(const std::string& path, const PointOptions& options, PointCloud& cloud, PointNotes& notes,
                        std::string& crs_wkt, const Context& context);

/// The same readers on bytes in memory; `name` is the file's name in messages.
void parse_text_points(const std::string& text, const std::string& name, PointCloud& cloud, PointNotes& notes,
                       const Context& context = {});
void parse_ply_points(const std::string& bytes, const std::string& name, PointCloud& cloud, PointNotes& notes,
                      const Context& context = {});
void parse_obj_points(const std::string& text, const std::string& name, PointCloud& cloud, PointNotes& notes,
                      const Context& context = {});
void parse_las_points(const std::string& content, const std::string& name, PointCloud& cloud, PointNotes& notes,
                      std::string& crs, const Context& context = {});

}  // namespace retalho
