// PLY: the vertex element of ascii and binary files; other elements are walked over.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "retalho/cloud/formats.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Encoding { ascii, little, big };

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count;  // a list's count type
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::string format;
  std::vector<Element> elements;
  std::size_t body = 0;   // offset of the first byte behind the header
  std::size_t lines = 0;  // lines of the header
};

std::optional<Type> type_of(const std::string& word) {
  static const std::array<std::array<const char*, 2>, 8> names{{{"char", "int8"},
                                                                {"uchar", "uint8"},
                                                                {"short", "int16"},
                                                                {"ushort", "uint16"},
                                                                {"int", "int32"},
                                                                {"uint", "uint32"},
                                                                {"float", "float32"},
                                                                {"double", "float64"}}};
  for (std::size_t k = 0; k < names.size(); ++k)
    if (word == names[k][0] || word == names[k][1]) return static_cast<Type>(k);
  return std::nullopt;
}

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

class HeaderParser {
 public:
  HeaderParser(const std::string& bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Header parse() {
    if (next_line() != "ply") fail("not a PLY file: the first line is not 'ply'");
    for (;;) {
      std::istringstream words(next_line());
      std::string keyword;
      words >> keyword;
      if (keyword == "end_header") break;
      if (keyword.empty() || keyword == "comment" || keyword == "obj_info") continue;
      if (keyword == "format") {
        format(words);
      } else if (keyword == "element") {
        Element element;
        if (!(words >> element.name >> element.count)) fail("an element needs a name and a count");
        header_.elements.push_back(element);
      } else if (keyword == "property") {
        property(words);
      } else {
        fail(fmt::format("unknown word '{}' in the header", keyword.substr(0, 40)));
      }
    }
    if (header_.format.empty()) fail("the header has no format line");
    header_.body = at_;
    header_.lines = line_;
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw CannotRead(fmt::format("'{}', line {}: {}", name_, line_, what), name_, fmt::format("line {}", line_));
  }
  std::string next_line() {
    ++line_;
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) fail("the file ends inside the header (no end_header line)");
    std::string text = bytes_.substr(at_, end - at_);
    if (!text.empty() && text.back() == '\r') text.pop_back();
    at_ = end + 1;
    return text;
  }
  void format(std::istringstream& words) {
    words >> header_.format;
    if (header_.format == "ascii")
      header_.encoding = Encoding::ascii;
    else if (header_.format == "binary_little_endian")
      header_.encoding = Encoding::little;
    else if (header_.format == "binary_big_endian")
      header_.encoding = Encoding::big;
    else
      fail(fmt::format("unknown format '{}'", header_.format.substr(0, 40)));
  }
  void property(std::istringstream& words) {
    if (header_.elements.empty()) fail("a property before any element");
    Property p;
    std::string type, count;
    words >> type;
    if (type == "list") {
      words >> count >> type;
      p.count = type_of(count);
      if (!p.count || *p.count >= Type::float32) fail(fmt::format("'{}' cannot count a list", count.substr(0, 40)));
    }
    const auto known = type_of(type);
    if (!known || !(words >> p.name)) fail("a property needs a type and a name");
    p.type = *known;
    header_.elements.back().properties.push_back(p);
  }

  const std::string& bytes_;
  const std::string& name_;
  Header header_;
  std::size_t at_ = 0, line_ = 0;
};

/// Values of the body, one after the other, whatever the encoding.
class Body {
 public:
  Body(const std::string& bytes, const Header& header, const std::string& name)
      : bytes_(bytes), encoding_(header.encoding), name_(name), at_(header.body), line_(header.lines + 1) {}

  std::size_t left() const { return bytes_.size() - at_; }

  double value(Type type, const Element& element, std::uint64_t index) {
    return encoding_ == Encoding::ascii ? ascii(element, index) : binary(type, element, index);
  }
  void skip(std::size_t bytes, const Element& element, std::uint64_t index) {
    if (left() < bytes) cut(element, index);
    at_ += bytes;
  }
  [[noreturn]] void fail(const std::string& what, const Element& element, std::uint64_t index) const {
    const std::string where =
        encoding_ == Encoding::ascii ? fmt::format("line {}", line_) : fmt::format("{} {}", element.name, index);
    throw CannotRead(fmt::format("'{}', {}: {}", name_, where, what), name_, where);
  }

 private:
  [[noreturn]] void cut(const Element& element, std::uint64_t index) const {
    fail(fmt::format("the file ends at {} {} of {}: it is cut off", element.name, index, element.count), element,
         index);
  }
  double ascii(const Element& element, std::uint64_t index) {
    while (at_ < bytes_.size() && (bytes_[at_] == ' ' || (bytes_[at_] >= '\t' && bytes_[at_] <= '\r'))) {
      if (bytes_[at_] == '\n') ++line_;
      ++at_;
    }
    if (at_ == bytes_.size()) cut(element, index);
    std::size_t end = at_;
    while (end < bytes_.size() && bytes_[end] != ' ' && !(bytes_[end] >= '\t' && bytes_[end] <= '\r')) ++end;
    const std::string_view word(bytes_.data() + at_, end - at_);
    double v = 0;
    const char* const begin = word.data() + (word.size() > 1 && word[0] == '+' && word[1] != '-' ? 1 : 0);
    const auto [stop, error] = std::from_chars(begin, word.data() + word.size(), v);
    if (stop != word.data() + word.size() || (error != std::errc() && error != std::errc::result_out_of_range))
      fail(fmt::format("'{}' is not a number ({} {})", word.substr(0, 40), element.name, index), element, index);
    at_ = end;
    return v;
  }
  template <class T>
  double decode() {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    if ((encoding_ == Encoding::big) == (std::endian::native == std::endian::little))
      std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return static_cast<double>(std::bit_cast<T>(raw));
  }
  double binary(Type type, const Element& element, std::uint64_t index) {
    if (left() < size_of(type)) cut(element, index);
    switch (type) {
      case Type::int8:
        return decode<std::int8_t>();
      case Type::uint8:
        return decode<std::uint8_t>();
      case Type::int16:
        return decode<std::int16_t>();
      case Type::uint16:
        return decode<std::uint16_t>();
      case Type::int32:
        return decode<std::int32_t>();
      case Type::uint32:
        return decode<std::uint32_t>();
      case Type::float32:
        return decode<float>();
      default:
        return decode<double>();
    }
  }

  const std::string& bytes_;
  Encoding encoding_;
  const std::string& name_;
  std::size_t at_, line_;
};

/// Reads a list's items away.
void skip_list(Body& body, const Property& property, const Element& element, std::uint64_t index, bool ascii) {
  const double count = body.value(*property.count, element, index);
  if (!(count >= 0) || count != std::floor(count) || count > 4294967295.0)
    body.fail(fmt::format("a list of {} items", count), element, index);
  if (!ascii) return body.skip(static_cast<std::size_t>(count) * size_of(property.type), element, index);
  for (double k = 0; k < count; ++k) body.value(property.type, element, index);
}

/// The least bytes that one element takes: what its count is checked against before anything is allocated.
std::size_t least_bytes(const Element& element, bool ascii) {
  std::size_t sum = 0;
  for (const Property& p : element.properties) sum += ascii ? 2 : size_of(p.count ? *p.count : p.type);
  return sum;
}

void read_vertices(Body& body, const Element& element, bool ascii, const std::string& name, PointCloud& cloud,
                   PointNotes& notes, const Context& context) {
  constexpr std::array<const char*, 6> names{"x", "y", "z", "nx", "ny", "nz"};
  std::array<std::size_t, 6> place;
  place.fill(element.properties.size());
  for (std::size_t k = 0; k < element.properties.size(); ++k)
    for (std::size_t which = 0; which < 6; ++which)
      if (element.properties[k].name == names[which] && !element.properties[k].count) place[which] = k;
  for (std::size_t which = 0; which < 3; ++which)
    if (place[which] == element.properties.size())
      throw BadInput(fmt::format("'{}': its vertices have no property '{}'", name, names[which]), name);
  const bool normals = place[3] < element.properties.size() && place[4] < element.properties.size() &&
                       place[5] < element.properties.size();
  const std::size_t least = least_bytes(element, ascii);
  if (element.count > body.left() / least + 1)
    body.fail(fmt::format("the header promises {} vertices, but only {} bytes follow: the file is cut off or damaged",
                          element.count, body.left()),
              element, 0);

  cloud.positions.reserve(element.count);
  if (normals) cloud.normals.reserve(element.count);
  std::vector<double> values(element.properties.size() + 1);
  for (std::uint64_t index = 0; index < element.count; ++index) {
    if (index % 65536 == 0) {
      context.check();
      context.report("read", static_cast<double>(index) / static_cast<double>(element.count));
    }
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      if (element.properties[k].count)
        skip_list(body, element.properties[k], element, index, ascii);
      else
        values[k] = body.value(element.properties[k].type, element, index);
    }
    const Vec3 p{values[place[0]], values[place[1]], values[place[2]]};
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      if (notes.skipped++ == 0)
        notes.remarks.push_back(fmt::format("vertices that are not finite are left out (the first: vertex {})", index));
      continue;
    }
    cloud.positions.push_back(p);
    if (normals) cloud.normals.push_back({values[place[3]], values[place[4]], values[place[5]]});
  }
  notes.columns = fmt::format("x, y, z{} of {} properties", normals ? ", normals" : "", element.properties.size());
}

}  // namespace

void parse_ply_points(const std::string& bytes, const std::string& name, PointCloud& cloud, PointNotes& notes,
                      const Context& context) {
  const Header header = HeaderParser(bytes, name).parse();
  const bool ascii = header.encoding == Encoding::ascii;
  notes.format = fmt::format("PLY ({})", header.format);
  Body body(bytes, header, name);
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      read_vertices(body, element, ascii, name, cloud, notes, context);
      for (const Element& other : header.elements)
        if (other.name == "face" && other.count > 0)
          notes.remarks.push_back(fmt::format("its {} faces are left out: only the vertices are used", other.count));
      return;
    }
    for (std::uint64_t index = 0; index < element.count && !element.properties.empty(); ++index)
      for (const Property& property : element.properties) {
        if (property.count)
          skip_list(body, property, element, index, ascii);
        else
          body.value(property.type, element, index);
      }
  }
  throw BadInput(fmt::format("'{}' has no vertices (no element 'vertex')", name), name);
}

void read_ply_points(const std::string& path, PointCloud& cloud, PointNotes& notes, const Context& context) {
  parse_ply_points(read_file(path), path, cloud, notes, context);
}

}  // namespace retalho
