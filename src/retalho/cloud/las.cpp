// LAS 1.0 to 1.4, uncompressed: coordinates, CRS from its own records, withheld points left out (ASPRS LAS
// specification 1.4 R15; all numbers little-endian).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "retalho/cloud/formats.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

static_assert(std::endian::native == std::endian::little, "LAS is read by copying little-endian numbers");

/// Shortest record of each point format 0 to 10.
constexpr std::array<std::size_t, 11> kShortest{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::size_t kRecordHeader = 54;  // of a variable length record

class Bytes {
 public:
  Bytes(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  template <class T>
  T get(std::size_t at) const {
    if (at > bytes_.size() || sizeof(T) > bytes_.size() - at)
      throw CannotRead(
          fmt::format("'{}' is cut off: {} bytes, and byte {} is needed", name_, bytes_.size(), at + sizeof(T) - 1),
          name_);
    T value;
    std::memcpy(&value, bytes_.data() + at, sizeof(T));
    return value;
  }
  std::string_view text(std::size_t at, std::size_t length) const {
    if (at > bytes_.size() || length > bytes_.size() - at)
      throw CannotRead(
          fmt::format("'{}' is cut off: {} bytes, and byte {} is needed", name_, bytes_.size(), at + length - 1),
          name_);
    const std::string_view field = bytes_.substr(at, length);
    return field.substr(0, field.find('\0'));
  }
  std::size_t size() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
  const std::string& name_;
};

/// The EPSG code in a directory of GeoTIFF keys: the projected CRS, else the geographic one; empty: none.
std::string epsg_of(const Bytes& bytes, std::size_t at, std::size_t length) {
  constexpr std::uint16_t kProjected = 3072, kGeographic = 2048, kOwn = 32767;
  const std::size_t keys = std::min<std::size_t>(bytes.get<std::uint16_t>(at + 6), length / 8 - 1);
  std::string geographic;
  for (std::size_t k = 1; k <= keys; ++k) {
    const auto id = bytes.get<std::uint16_t>(at + 8 * k), place = bytes.get<std::uint16_t>(at + 8 * k + 2),
               value = bytes.get<std::uint16_t>(at + 8 * k + 6);
    if (place != 0 || value == 0 || value == kOwn) continue;
    if (id == kProjected) return fmt::format("EPSG:{}", value);
    if (id == kGeographic) geographic = fmt::format("EPSG:{}", value);
  }
  return geographic;
}

/// The CRS that the file's records name: WKT, or EPSG codes among GeoTIFF keys.
std::string crs_of(const Bytes& bytes, std::size_t at, std::uint32_t records, std::size_t end) {
  std::string epsg;
  for (std::uint32_t k = 0; k < records && at + kRecordHeader <= end; ++k) {
    const std::string_view user = bytes.text(at + 2, 16);
    const auto id = bytes.get<std::uint16_t>(at + 18);
    const std::size_t length = bytes.get<std::uint16_t>(at + 20), body = at + kRecordHeader;
    if (body + length > end) break;
    if (user == "LASF_Projection" && id == 2112) return std::string(bytes.text(body, length));
    if (user == "LASF_Projection" && id == 34735 && length >= 8) epsg = epsg_of(bytes, body, length);
    at = body + length;
  }
  return epsg;
}

}  // namespace

void parse_las_points(const std::string& content, const std::string& name, PointCloud& cloud, PointNotes& notes,
                      std::string& crs, const Context& context) {
  const Bytes bytes(content, name);
  if (bytes.text(0, 4) != "LASF")
    throw CannotRead(fmt::format("'{}' is no LAS file: it does not begin with LASF", name), name);
  const int minor = bytes.get<std::uint8_t>(25);
  const std::size_t header = bytes.get<std::uint16_t>(94), start = bytes.get<std::uint32_t>(96);
  const std::uint32_t records = bytes.get<std::uint32_t>(100);
  const int format = bytes.get<std::uint8_t>(104);
  const std::size_t length = bytes.get<std::uint16_t>(105);
  if ((format & 0xc0) != 0)
    throw CannotRead(
        fmt::format("'{}' is compressed (LAZ), which is not read: write it as LAS first (laszip, pdal)", name), name);
  if (format > 10)
    throw CannotRead(fmt::format("'{}': point format {} is not known (0 to 10 are)", name, format), name);
  if (length < kShortest[static_cast<std::size_t>(format)] || header < 227 || start < header)
    throw CannotRead(fmt::format("'{}': the header is damaged (point records of {} bytes at byte {}, header of {})",
                                 name, length, start, header),
                     name);
  std::uint64_t count = bytes.get<std::uint32_t>(107);
  if (minor >= 4 && header >= 375) count = bytes.get<std::uint64_t>(247);
  std::array<double, 3> scale{}, offset{};
  for (std::size_t k = 0; k < 3; ++k) {
    scale[k] = bytes.get<double>(131 + 8 * k);
    offset[k] = bytes.get<double>(155 + 8 * k);
    if (!std::isfinite(scale[k]) || scale[k] == 0 || !std::isfinite(offset[k]))
      throw CannotRead(fmt::format("'{}': the header is damaged (scale {}, offset {} of coordinate {})", name, scale[k],
                                   offset[k], "xyz"[k]),
                       name);
  }
  // Before anything is allocated: are the points that it claims there?
  if (start > bytes.size() || count > (bytes.size() - start) / length)
    throw CannotRead(
        fmt::format("'{}' is cut off: {} points of {} bytes from byte {} on are promised, and it has {} bytes", name,
                    count, length, start, bytes.size()),
        name);
  crs = crs_of(bytes, header, records, start);
  cloud.positions.reserve(count);
  std::size_t withheld = 0;
  for (std::uint64_t k = 0; k < count; ++k) {
    if (k % 65536 == 0) {
      context.check();
      context.report("read", static_cast<double>(k) / static_cast<double>(count));
    }
    const std::size_t at = start + k * length;
    const auto flags = bytes.get<std::uint8_t>(at + 15);
    if ((flags & (format < 6 ? 0x80 : 0x04)) != 0) {
      ++withheld;
      continue;
    }
    const Vec3 p{scale[0] * bytes.get<std::int32_t>(at) + offset[0],
                 scale[1] * bytes.get<std::int32_t>(at + 4) + offset[1],
                 scale[2] * bytes.get<std::int32_t>(at + 8) + offset[2]};
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))
      cloud.positions.push_back(p);
    else
      ++notes.skipped;
  }
  notes.format = fmt::format("LAS 1.{}, point format {}", minor, format);
  notes.columns = "x, y, z";
  if (withheld > 0) notes.remarks.push_back(fmt::format("{} points that the file withholds are left out", withheld));
}

void read_las_points(const std::string& path, PointCloud& cloud, PointNotes& notes, std::string& crs,
                     const Context& context) {
  parse_las_points(read_file(path), path, cloud, notes, crs, context);
}

}  // namespace retalho
