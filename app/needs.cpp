#include "needs.h"

#include <fmt/format.h>

#include <filesystem>

#include "retalho/core/error.h"
#include "retalho/core/memory.h"
#include "retalho/raster/io.h"

namespace retalho::app {
namespace {

constexpr double kHeight = sizeof(float);  // doubles are held against the limit by the reader, who knows the type

double in_proportion(const std::string& file, double bytes_a_byte) {
  std::error_code ec;
  const auto bytes = std::filesystem::file_size(file, ec);
  return ec ? 0 : bytes_a_byte * static_cast<double>(bytes);  // a folder, a pipe, a name of GDAL's: the watch has to do
}

}  // namespace

void check_grid_need(const Need& need, const std::string& file, int band) {
  // What is read only once is not opened for its size: a pipe, and GDAL's name for standard input.
  std::error_code ec;
  if (file.starts_with("/vsistdin") || std::filesystem::is_fifo(file, ec)) return;
  Raster place;
  try {
    place = inspect_raster(file, {.band = band});
  } catch (const Error&) {  // of a form that says no size (ASCII PGM), or wrong, which the reader says better
    return;
  }
  check_memory(kProcessMemory + static_cast<double>(place.cells()) * (kHeight + need.a_cell) + need.more +
                   need.a_column * place.columns,
               fmt::format("{} {} x {} cells", need.work, place.columns, place.rows), file);
}

void check_file_need(const std::string& work, double bytes_a_byte, const std::string& file) {
  const double bytes = in_proportion(file, bytes_a_byte);
  if (bytes > 0) check_memory(kProcessMemory + bytes, fmt::format("{} '{}'", work, file), file);
}

void check_terrain_need(const std::string& work, const Terrain& terrain, double a_vertex, double more,
                        const std::string& file) {
  check_vertex_need(work, terrain.tin.vertex_count(), a_vertex, more, file);
}

void check_vertex_need(const std::string& work, std::size_t vertices, double a_vertex, double more,
                       const std::string& file) {
  check_memory(kProcessMemory + a_vertex * static_cast<double>(vertices) + more,
               fmt::format("{} a model of {} vertices", work, vertices), file);
}

}  // namespace retalho::app
