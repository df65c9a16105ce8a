#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/mesh/globe_mesh.h"
#include "retalho/mesh/mesh_stream.h"
#include "retalho/mesh/quantized_tile.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/raster/geodetic.h"
#include "retalho/tin/refine.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;
constexpr int kSide = kQuantizedMeshCells + 1, kMostLevel = 24;
constexpr double kMostTiles = 1e6;
constexpr double kNudge = 1e-6;  // degrees, 0.1 m: for the slope of the CRS against longitude and latitude
constexpr int kOutline = 64;     // points along each side of the model that its box in degrees is taken from

struct Box {
  double west = 1e300, south = 1e300, east = -1e300, north = -1e300;
};

/// Of the model's outline and inside, in degrees.
Box box_of(const GlobeSurface& surface, const Geodetic& geodetic) {
  const Vec3 low = surface.low, high = surface.high;
  std::vector<Vec2> points;
  for (int i = 0; i <= kOutline; ++i)
    for (int j = 0; j <= kOutline; ++j)
      points.push_back(
          surface.georef.to_crs({low.x + (high.x - low.x) * i / kOutline, low.y + (high.y - low.y) * j / kOutline}));
  geodetic.to_degrees(points);
  Box box;
  for (const Vec2 p : points) {
    if (std::isnan(p.x) || std::abs(p.y) > 90) continue;
    box = {std::min(box.west, p.x), std::min(box.south, p.y), std::max(box.east, p.x), std::max(box.north, p.y)};
  }
  if (!(box.west < box.east && box.south < box.north) || box.west < -180 || box.east > 180)
    throw BadInput(
        "the model cannot be put on the globe: its corners have no longitudes and latitudes from -180 to 180");
  return box;
}

double size_of(int level) {  // degrees
  return 180.0 / static_cast<double>(1LL << level);
}

struct Place {
  int level = 0;
  long x = 0, y = 0;
};

/// The tiles of a level that touch the box; at level 0 both.
std::array<long, 4> range_of(const Box& box, int level) {
  const double size = size_of(level);
  const long columns = 2L << level, rows = 1L << level;
  if (level == 0) return {0, 0, 1, 0};
  const auto at = [&](double degrees, long count) {
    return std::clamp(static_cast<long>(std::floor(degrees / size)), 0L, count - 1);
  };
  return {at(box.west + 180, columns), at(box.south + 90, rows), at(box.east + 180, columns), at(box.north + 90, rows)};
}

int finest_level(const GlobeSurface& surface, const Box& box, const QuantizedMeshOptions& options) {
  if (options.level > kMostLevel)
    throw UsageError(fmt::format("the finest level must be 0 to {}, not {}", kMostLevel, options.level));
  if (options.level >= 0) return options.level;
  const double cell = std::max((box.east - box.west) / surface.columns, 1e-9);
  int level = 0;
  while (level < kMostLevel && size_of(level) / kQuantizedMeshCells > cell) ++level;
  return level;
}

/// What all tiles share.
struct Work {
  const GlobeSurface& surface;
  const QuantizedMeshOptions& options;
  Box box;
  int finest = 0;
  double tolerance = 0, step = 1;
};

struct Samples {
  std::vector<double> heights;  // rows from north
  std::vector<Vec3> normals;
};

std::uint16_t coordinate(int k) {  // of sample k of 0 to kQuantizedMeshCells
  return static_cast<std::uint16_t>((k * kQuantizedMost + kQuantizedMeshCells / 2) / kQuantizedMeshCells);
}

/// Degrees from whole numbers of the level's own lattice: the same bits from both tiles of an edge.
double degrees_of(long tile, int k, int level, double from) {
  return from + static_cast<double>(tile * kQuantizedMost + coordinate(k)) * (size_of(level) / kQuantizedMost);
}

Samples sample(const Work& work, const Geodetic& geodetic, const Place& at) {
  const Georef& georef = work.surface.georef;
  const auto count = static_cast<std::size_t>(kSide * kSide);
  std::vector<Vec2> degrees, points;
  degrees.reserve(count);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      degrees.push_back({degrees_of(at.x, c, at.level, -180), degrees_of(at.y, kSide - 1 - r, at.level, -90)});
  points.reserve(3 * count);
  for (const Vec2 nudge : {Vec2{0, 0}, Vec2{kNudge, 0}, Vec2{0, kNudge}})
    for (const Vec2 d : degrees)
      points.push_back({d.x + (d.x < 179 ? nudge.x : -nudge.x), d.y + (d.y < 89 ? nudge.y : -nudge.y)});
  geodetic.from_degrees(points);
  std::vector<Vec2> local;
  local.reserve(count);
  for (std::size_t k = 0; k < count; ++k) local.push_back(georef.to_local(points[k]));
  const std::vector<std::optional<Jet>> jets = work.surface.jets(local);
  Samples samples;
  samples.heights.assign(count, work.options.outside);
  samples.normals.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const EastNorthUp frame = east_north_up(degrees[k]);
    samples.normals.push_back(frame.up);
    const Vec2 p = local[k];
    const std::optional<Jet>& jet = jets[k];
    if (!jet) continue;
    samples.heights[k] = jet->value;
    // The way that a nudge goes, in the model and on the globe, gives the slope to the east and to the north.
    const double sx = degrees[k].x < 179 ? 1 : -1, sy = degrees[k].y < 89 ? 1 : -1;
    const Vec2 px = georef.to_local(points[count + k]) - p, py = georef.to_local(points[2 * count + k]) - p;
    const Vec3 here = earth_centred(degrees[k], 0);
    const double east = norm(earth_centred({degrees[k].x + sx * kNudge, degrees[k].y}, 0) - here) * sx;
    const double north = norm(earth_centred({degrees[k].x, degrees[k].y + sy * kNudge}, 0) - here) * sy;
    const double a = dot(jet->gradient, px) / east, b = dot(jet->gradient, py) / north;
    if (std::isfinite(a) && std::isfinite(b))
      samples.normals.back() = normalized(frame.up - a * frame.east - b * frame.north);
  }
  return samples;
}

double lowest_of(const Samples& samples, double step) {
  return std::floor(*std::min_element(samples.heights.begin(), samples.heights.end()) / step) * step;
}

QuantizedTile tile_of(const Work& work, const Samples& samples, const Place& at) {
  QuantizedTile tile;
  tile.size = size_of(at.level);
  tile.west = -180 + static_cast<double>(at.x) * tile.size;
  tile.south = -90 + static_cast<double>(at.y) * tile.size;
  tile.step = work.step;
  tile.lowest = lowest_of(samples, work.step);
  Raster raster;  // of what will be decoded
  raster.columns = raster.rows = kSide;
  std::vector<double> heights;
  heights.reserve(samples.heights.size());
  for (const double z : samples.heights) heights.push_back(std::round(z / work.step) * work.step);
  raster.heights = heights;
  if (*std::max_element(heights.begin(), heights.end()) > tile.lowest + kQuantizedMost * tile.step)
    throw BadInput("the surface passes the heights of its vertices by more than a half of their range");
  const double tolerance = std::ldexp(work.tolerance, work.finest - at.level);
  const GridTin tin = refine_grid(raster, {.max_error = tolerance}, {.threads = 1});
  for (const std::uint32_t cell : tin.cells) {
    const int column = static_cast<int>(cell & 0xffffU), row = static_cast<int>(cell >> 16);
    const std::size_t k = raster.index(column, row);
    tile.vertices.push_back({coordinate(column), coordinate(kSide - 1 - row),
                             static_cast<std::uint16_t>(std::lround((heights[k] - tile.lowest) / work.step)),
                             samples.normals[k]});
  }
  tile.triangles = tin.triangles;
  return tile;
}

nlohmann::ordered_json layer_of(const Work& work, const std::vector<std::array<long, 4>>& ranges) {
  nlohmann::ordered_json available = nlohmann::ordered_json::array();
  for (const auto& [x0, y0, x1, y1] : ranges)
    available.push_back({{{"startX", x0}, {"startY", y0}, {"endX", x1}, {"endY", y1}}});
  nlohmann::ordered_json layer = {{"tilejson", "2.1.0"},
                                  {"name", "retalho"},
                                  {"version", "1.0.0"},
                                  {"format", "quantized-mesh-1.0"},
                                  {"scheme", "tms"},
                                  {"projection", "EPSG:4326"},
                                  {"tiles", {"{z}/{x}/{y}.terrain"}},
                                  {"minzoom", 0},
                                  {"maxzoom", work.finest},
                                  {"bounds", {work.box.west, work.box.south, work.box.east, work.box.north}},
                                  {"available", available}};
  if (work.options.normals) layer["extensions"] = {"octvertexnormals"};
  return layer;
}

void make_folder(const fs::path& folder) {
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (ec)
    throw CannotWrite(fmt::format("cannot make the folder '{}': {}", folder.string(), ec.message()), folder.string());
}

/// A power of two, such that all heights of any tile are within 32767 of it, and whole numbers of it are floats.
double step_of(const GlobeSurface& surface, double outside) {
  const double low = std::min(outside, surface.low.z), high = std::max(outside, surface.high.z);
  const double range = 1.5 * (high - low) + 1;  // a smooth surface passes its vertices' range a little
  const double largest = std::max(std::abs(low), std::abs(high)) + range;
  double step = std::exp2(std::ceil(std::log2(range / (kQuantizedMost - 1))));
  while ((largest + kQuantizedMost * step) / step > (1 << 24)) step *= 2;
  return step;
}

/// Each square of 2 x 2 places, of 4 x 4 and so on, one after the other: what a surface has read for one is used again.
void sort_by_squares(std::vector<Place>& places) {
  const auto code = [](const Place& at) {
    std::uint64_t bits = 0;
    for (unsigned k = 0; k <= kMostLevel; ++k)
      bits |= ((static_cast<std::uint64_t>(at.x) >> k & 1U) << (2 * k)) |
              ((static_cast<std::uint64_t>(at.y) >> k & 1U) << (2 * k + 1));
    return bits;
  };
  std::sort(places.begin(), places.end(),
            [&](const Place& a, const Place& b) { return a.level != b.level ? a.level < b.level : code(a) < code(b); });
}

}  // namespace

GlobeSurface globe_surface(const TerrainEvaluator& model) {
  const Terrain& terrain = model.terrain();
  GlobeSurface surface;
  surface.georef = terrain.georef;
  const auto place = [&](std::size_t v) {
    return Vec3{terrain.tin.points[v].x, terrain.tin.points[v].y, terrain.tin.heights[v]};
  };
  surface.low = surface.high = place(0);
  for (std::size_t v = 1; v < terrain.tin.vertex_count(); ++v) widen(surface.low, surface.high, place(v));
  surface.columns =
      terrain.grid.columns > 0 ? terrain.grid.columns : std::sqrt(static_cast<double>(terrain.tin.vertex_count()));
  surface.jets = [&model](std::span<const Vec2> points) {
    std::vector<std::optional<Jet>> jets;
    jets.reserve(points.size());
    for (const Vec2 p : points) jets.push_back(std::isnan(p.x) || std::isnan(p.y) ? std::nullopt : model.jet(p));
    return jets;
  };
  return surface;
}

GlobeNotes write_quantized_mesh(const TerrainEvaluator& model, const std::string& folder,
                                const QuantizedMeshOptions& options, bool overwrite, const Context& context) {
  return write_quantized_mesh(globe_surface(model), folder, options, overwrite, context);
}

GlobeNotes write_quantized_mesh(const GlobeSurface& surface, const std::string& folder,
                                const QuantizedMeshOptions& options, bool overwrite, const Context& context) {
  const Geodetic geodetic(surface.georef.crs_wkt);
  Work work{surface, options, box_of(surface, geodetic)};
  work.tolerance = mesh_tolerance(surface.low.z, surface.high.z, {.tolerance = options.tolerance});
  work.finest = finest_level(surface, work.box, options);
  if (!std::isfinite(options.outside)) throw UsageError("the height outside of the model must be a number");
  work.step = step_of(surface, options.outside);
  std::vector<Place> places;
  std::vector<std::array<long, 4>> ranges;
  double count = 0;
  for (int level = 0; level <= work.finest; ++level) {
    ranges.push_back(range_of(work.box, level));
    const auto& [x0, y0, x1, y1] = ranges.back();
    count += static_cast<double>(x1 - x0 + 1) * static_cast<double>(y1 - y0 + 1);
    if (count > kMostTiles)
      throw UsageError(
          fmt::format("{} levels would make more than a million tiles: give a coarser one", work.finest + 1));
    for (long y = y0; y <= y1; ++y)
      for (long x = x0; x <= x1; ++x) places.push_back({level, x, y});
  }
  const fs::path root(folder), layer = root / "layer.json";
  if (fs::exists(layer) && !overwrite)
    throw CannotWrite(fmt::format("'{}' exists: --overwrite replaces it", layer.string()), layer.string());
  sort_by_squares(places);
  for (const Place& at : places) make_folder(root / std::to_string(at.level) / std::to_string(at.x));
  std::vector<std::size_t> triangles(places.size()), bytes(places.size());
  parallel_chunks(places.size(), 1, context, [&](std::size_t begin, std::size_t end) {
    const Geodetic own(surface.georef.crs_wkt);
    for (std::size_t k = begin; k < end; ++k) {
      const Place& at = places[k];
      const QuantizedTile tile = tile_of(work, sample(work, own, at), at);
      triangles[k] = tile.triangles.size();
      std::string text = encode_tile(tile, options.normals);
      if (options.gzip) text = gzip(text);
      bytes[k] = text.size();
      write_file((root / std::to_string(at.level) / std::to_string(at.x) / fmt::format("{}.terrain", at.y)).string(),
                 text, true);
    }
  });
  write_file(layer.string(), layer_of(work, ranges).dump(1) + "\n", overwrite);
  GlobeNotes notes;
  notes.tiles = places.size();
  notes.levels = work.finest + 1;
  notes.step = work.step;
  for (std::size_t k = 0; k < places.size(); ++k) {
    notes.triangles += triangles[k];
    notes.bytes += bytes[k];
  }
  return notes;
}

}  // namespace retalho
