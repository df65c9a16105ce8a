#include "retalho/mesh/quantized_tile.h"

#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

#include "retalho/core/error.h"
#include "retalho/raster/geodetic.h"

namespace retalho {
namespace {

constexpr std::uint8_t kNormalsExtension = 1;
constexpr std::size_t kMostShort = 65536;  // vertices whose numbers fit into 16 bits
constexpr double kNeverHidden = 1e3;       // radii: an occlusion point so far away is seen from everywhere

class Bytes {
 public:
  template <typename T>
  void put(T value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    text_.append(raw, sizeof value);
  }
  void align(std::size_t to) { text_.resize((text_.size() + to - 1) / to * to, '\0'); }
  void put(Vec3 v) { put(v.x), put(v.y), put(v.z); }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void order_by_use(QuantizedTile& tile) {
  constexpr std::uint32_t kUnused = 0xffffffffU;
  std::vector<std::uint32_t> number(tile.vertices.size(), kUnused);
  std::vector<QuantizedVertex> vertices;
  for (auto& t : tile.triangles)
    for (std::uint32_t& v : t) {
      if (number[v] == kUnused) {
        number[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(tile.vertices[v]);
      }
      v = number[v];
    }
  tile.vertices = std::move(vertices);
}

Vec3 place(const QuantizedTile& tile, const QuantizedVertex& v) {
  return earth_centred({tile.west + tile.size * v.u / kQuantizedMost, tile.south + tile.size * v.v / kQuantizedMost},
                       tile.lowest + tile.step * v.height);
}

/// Along `direction`, in the frame where the ellipsoid is the unit sphere: the nearest point from which, seen over the
/// horizon, the tile is hidden whenever the point is ("Horizon culling", Ring 2013).
Vec3 occlusion_point(const std::vector<Vec3>& points, Vec3 direction) {
  const auto scaled = [](Vec3 p) { return Vec3{p.x / kWgs84Equator, p.y / kWgs84Equator, p.z / kWgs84Pole}; };
  const Vec3 along = normalized(scaled(direction));
  double most = 0;
  for (const Vec3& p : points) {
    const Vec3 s = scaled(p);
    const double length2 = std::max(1.0, dot(s, s)), length = std::sqrt(length2);
    const Vec3 to = normalized(s);
    const double cos_a = dot(along, to), sin_a = norm(cross(along, to));
    const double cos_b = 1 / length, sin_b = std::sqrt(length2 - 1) * cos_b;
    const double below = cos_a * cos_b - sin_a * sin_b;
    most = std::max(most, below > 1 / kNeverHidden ? 1 / below : kNeverHidden);
  }
  return most * along;
}

void put_header(const QuantizedTile& tile, Bytes& out) {
  std::vector<Vec3> points;
  points.reserve(tile.vertices.size());
  Vec3 low{1e300, 1e300, 1e300}, high = -1.0 * low;
  for (const QuantizedVertex& v : tile.vertices) {
    const Vec3 p = points.emplace_back(place(tile, v));
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 middle = 0.5 * (low + high);
  double radius = 0;
  for (const Vec3& p : points) radius = std::max(radius, norm(p - middle));
  const double highest = tile.lowest + kQuantizedMost * tile.step;
  const Vec3 centre =
      earth_centred({tile.west + tile.size / 2, tile.south + tile.size / 2}, (tile.lowest + highest) / 2);
  out.put(centre);
  out.put(static_cast<float>(tile.lowest));
  out.put(static_cast<float>(highest));
  out.put(middle);
  out.put(radius);
  out.put(occlusion_point(points, middle));
}

std::uint16_t zig_zag(int difference) {
  return static_cast<std::uint16_t>((difference << 1) ^ (difference >> 31));
}

template <typename Of>
void put_coordinates(const QuantizedTile& tile, Bytes& out, Of of) {
  int before = 0;
  for (const QuantizedVertex& v : tile.vertices) {
    const int now = of(v);
    out.put(zig_zag(now - before));
    before = now;
  }
}

template <typename Index>
void put_indices(const QuantizedTile& tile, Bytes& out) {
  out.align(sizeof(Index));
  out.put(static_cast<std::uint32_t>(tile.triangles.size()));
  std::uint32_t highest = 0;
  for (const auto& t : tile.triangles)
    for (const std::uint32_t v : t) {
      out.put(static_cast<Index>(highest - v));
      if (v == highest) ++highest;
    }
  const auto edge = [&](auto on, auto along) {
    std::vector<std::uint32_t> list;
    for (std::uint32_t v = 0; v < tile.vertices.size(); ++v)
      if (on(tile.vertices[v])) list.push_back(v);
    std::sort(list.begin(), list.end(),
              [&](std::uint32_t a, std::uint32_t b) { return along(tile.vertices[a]) < along(tile.vertices[b]); });
    out.put(static_cast<std::uint32_t>(list.size()));
    for (const std::uint32_t v : list) out.put(static_cast<Index>(v));
  };
  const auto u = [](const QuantizedVertex& p) { return p.u; };
  const auto v = [](const QuantizedVertex& p) { return p.v; };
  edge([](const QuantizedVertex& p) { return p.u == 0; }, v);
  edge([](const QuantizedVertex& p) { return p.v == 0; }, u);
  edge([](const QuantizedVertex& p) { return p.u == kQuantizedMost; }, v);
  edge([](const QuantizedVertex& p) { return p.v == kQuantizedMost; }, u);
}

}  // namespace

std::array<std::uint8_t, 2> oct_encode(Vec3 normal) {
  const double sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  double x = normal.x / sum, y = normal.y / sum;
  if (normal.z < 0) {
    const double folded = (1 - std::abs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::abs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  const auto byte = [](double c) {
    return static_cast<std::uint8_t>(std::lround((std::clamp(c, -1.0, 1.0) * 0.5 + 0.5) * 255));
  };
  return {byte(x), byte(y)};
}

std::string encode_tile(QuantizedTile tile, bool normals) {
  order_by_use(tile);
  Bytes out;
  put_header(tile, out);
  out.put(static_cast<std::uint32_t>(tile.vertices.size()));
  put_coordinates(tile, out, [](const QuantizedVertex& v) { return v.u; });
  put_coordinates(tile, out, [](const QuantizedVertex& v) { return v.v; });
  put_coordinates(tile, out, [](const QuantizedVertex& v) { return v.height; });
  if (tile.vertices.size() > kMostShort)
    put_indices<std::uint32_t>(tile, out);
  else
    put_indices<std::uint16_t>(tile, out);
  if (normals) {
    out.put(kNormalsExtension);
    out.put(static_cast<std::uint32_t>(2 * tile.vertices.size()));
    for (const QuantizedVertex& v : tile.vertices)
      for (const std::uint8_t byte : oct_encode(v.normal)) out.put(byte);
  }
  return out.take();
}

std::string gzip(const std::string& bytes) {
  z_stream stream{};
  constexpr int kWindow = 15, kGzip = 16, kMemory = 8;
  // With these settings, and room for deflateBound's bytes, only memory can be missing.
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kWindow + kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  [[maybe_unused]] const int end = deflate(&stream, Z_FINISH);
  assert(end == Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

}  // namespace retalho
