// PLY (Turk 1994), ASCII and binary: the elements `vertex` and `face`; others are walked over.
#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"

namespace retalho {
namespace {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr std::size_t size_of(Type t) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(t)];
}

std::optional<Type> type_named(std::string_view name) {
  constexpr struct {
    const char *name, *other;
    Type type;
  } kTypes[] = {{"char", "int8", Type::i8},      {"uchar", "uint8", Type::u8},    {"short", "int16", Type::i16},
                {"ushort", "uint16", Type::u16}, {"int", "int32", Type::i32},     {"uint", "uint32", Type::u32},
                {"float", "float32", Type::f32}, {"double", "float64", Type::f64}};
  for (const auto& t : kTypes)
    if (name == t.name || name == t.other) return t.type;
  return std::nullopt;
}

struct Property {
  std::string name;
  Type type = Type::f32;
  std::optional<Type> length;  ///< of a list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

/// Words and numbers, front to back; errors name the line (header, ASCII) or the element (binary).
class Source {
 public:
  Source(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  enum class Coding { ascii, little, big } coding = Coding::ascii;
  std::string element;  ///< what is being read, for messages

  [[noreturn]] void fail(const std::string& words) const {
    const std::string where = in_body_ && coding != Coding::ascii ? element : fmt::format("line {}", line_);
    throw CannotRead(fmt::format("'{}', {}: {}", path_, where, words), path_, where);
  }

  std::string_view header_line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) ++line_, fail("the header has no end_header");
    std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  void begin_body() { in_body_ = true, ++line_; }
  std::size_t left() const { return bytes_.size() - at_; }

  double number(Type type) {
    if (coding == Coding::ascii) return ascii_number();
    const std::size_t size = size_of(type);
    if (left() < size) fail("the file ends here");
    std::uint64_t word = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const auto byte = static_cast<unsigned char>(bytes_[at_ + k]);
      word |= std::uint64_t{byte} << (8 * (coding == Coding::little ? k : size - 1 - k));
    }
    at_ += size;
    switch (type) {
      case Type::i8:
        return static_cast<std::int8_t>(word);
      case Type::i16:
        return static_cast<std::int16_t>(word);
      case Type::i32:
        return static_cast<std::int32_t>(word);
      case Type::f32:
        return std::bit_cast<float>(static_cast<std::uint32_t>(word));
      case Type::f64:
        return std::bit_cast<double>(word);
      default:
        return static_cast<double>(word);
    }
  }

 private:
  double ascii_number() {
    while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_]))) line_ += bytes_[at_++] == '\n';
    if (at_ == bytes_.size()) fail(fmt::format("the file ends within {}", element));
    double value = 0;
    if (bytes_[at_] == '+') ++at_;
    const auto [end, error] = std::from_chars(bytes_.data() + at_, bytes_.data() + bytes_.size(), value);
    if (error != std::errc()) fail(fmt::format("not a number in {}", element));
    at_ = static_cast<std::size_t>(end - bytes_.data());
    return value;
  }

  std::string_view bytes_;
  const std::string& path_;
  std::size_t at_ = 0, line_ = 0;
  bool in_body_ = false;
};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

void read_coding(Source& in, const std::vector<std::string_view>& w) {
  if (w.size() < 2) in.fail("the format is missing");
  if (w[1] == "ascii")
    in.coding = Source::Coding::ascii;
  else if (w[1] == "binary_little_endian")
    in.coding = Source::Coding::little;
  else if (w[1] == "binary_big_endian")
    in.coding = Source::Coding::big;
  else
    in.fail(fmt::format("unknown format '{}'", w[1]));
}

std::vector<Element> read_header(Source& in) {
  if (in.header_line() != "ply") in.fail("not a PLY file: it does not begin with 'ply'");
  std::vector<Element> elements;
  const auto type = [&](std::string_view name) {
    const auto t = type_named(name);
    if (!t) in.fail(fmt::format("unknown type '{}'", name));
    return *t;
  };
  for (;;) {
    const std::vector<std::string_view> w = words_of(in.header_line());
    if (w.empty() || w[0] == "comment" || w[0] == "obj_info") continue;
    if (w[0] == "end_header") break;
    if (w[0] == "format") {
      read_coding(in, w);
    } else if (w[0] == "element" && w.size() == 3) {
      std::uint64_t count = 0;
      const auto [end, error] = std::from_chars(w[2].data(), w[2].data() + w[2].size(), count);
      if (error != std::errc() || end != w[2].data() + w[2].size())
        in.fail(fmt::format("'{}' is not a number of elements", w[2]));
      elements.push_back({std::string(w[1]), count, {}});
    } else if (w[0] == "property" && !elements.empty() && w.size() == 3) {
      elements.back().properties.push_back({std::string(w[2]), type(w[1]), std::nullopt});
    } else if (w[0] == "property" && !elements.empty() && w.size() == 5 && w[1] == "list") {
      elements.back().properties.push_back({std::string(w[4]), type(w[3]), type(w[2])});
    } else {
      in.fail(fmt::format("'{}' is not expected in a PLY header", w[0]));
    }
  }
  in.begin_body();
  return elements;
}

std::uint64_t list_length(Source& in, Type type) {
  const double length = in.number(type);
  if (!(length >= 0 && length <= static_cast<double>(in.left()) && length == std::floor(length)))
    in.fail(fmt::format("a list of {} numbers", length));
  return static_cast<std::uint64_t>(length);
}

void skip_property(Source& in, const Property& p) {
  const std::uint64_t n = p.length ? list_length(in, *p.length) : 1;
  for (std::uint64_t k = 0; k < n; ++k) in.number(p.type);
}

void read_vertices(Source& in, const Element& e, TriangleMesh& mesh) {
  constexpr const char* kNames[][3] = {
      {"x"}, {"y"}, {"z"}, {"nx"}, {"ny"}, {"nz"}, {"s", "u", "texture_u"}, {"t", "v", "texture_v"}};
  std::vector<int> slot(e.properties.size(), -1);
  unsigned found = 0;
  for (std::size_t p = 0; p < e.properties.size(); ++p)
    for (int s = 0; s < 8; ++s)
      for (const char* name : kNames[s])
        if (name && e.properties[p].name == name && !e.properties[p].length) slot[p] = s, found |= 1U << s;
  if ((found & 7) != 7) in.fail("the vertices have no x, y and z");
  const bool normals = (found & 0x38) == 0x38, texture = (found & 0xc0) == 0xc0;
  for (std::uint64_t i = 0; i < e.count; ++i) {
    in.element = fmt::format("vertex {}", i);
    double value[8] = {};
    for (std::size_t p = 0; p < e.properties.size(); ++p) {
      if (slot[p] < 0) {
        skip_property(in, e.properties[p]);
        continue;
      }
      const double v = in.number(e.properties[p].type);
      if (!std::isfinite(v)) in.fail(fmt::format("'{}' of {} is not finite", e.properties[p].name, in.element));
      value[slot[p]] = v;
    }
    mesh.positions.push_back({value[0], value[1], value[2]});
    if (normals) mesh.normals.push_back({value[3], value[4], value[5]});
    if (texture) mesh.texture.push_back({value[6], value[7]});
  }
}

void read_faces(Source& in, const Element& e, TriangleMesh& mesh, const std::string& path) {
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < e.count; ++i) {
    in.element = fmt::format("face {}", i);
    for (const Property& p : e.properties) {
      if (!p.length || (p.name != "vertex_indices" && p.name != "vertex_index")) {
        skip_property(in, p);
        continue;
      }
      corners.clear();
      const std::uint64_t n = list_length(in, *p.length);
      for (std::uint64_t k = 0; k < n; ++k) {
        const double v = in.number(p.type);
        if (!(v >= 0 && v < static_cast<double>(mesh.positions.size()) && v == std::floor(v)))
          throw BadInput(fmt::format("'{}': {} names vertex {} of {}", path, in.element, v, mesh.positions.size()),
                         path, in.element);
        corners.push_back(static_cast<std::uint32_t>(v));
      }
      if (n < 3) throw BadInput(fmt::format("'{}': {} has {} corners", path, in.element, n), path, in.element);
      for (std::size_t k = 1; k + 1 < corners.size(); ++k)
        mesh.triangles.push_back({corners[0], corners[k], corners[k + 1]});
    }
  }
}

}  // namespace

TriangleMesh read_ply(std::string_view bytes, const std::string& path) {
  Source in(bytes, path);
  const std::vector<Element> elements = read_header(in);
  TriangleMesh mesh;
  for (const Element& e : elements) {
    in.element = e.name;
    // Every element takes a byte at least (two in ASCII): nothing larger than the file is believed.
    if (e.count > in.left() && !e.properties.empty())
      in.fail(fmt::format("{} elements '{}' in {} bytes: the file was cut short", e.count, e.name, in.left()));
    if (e.name == "vertex") {
      read_vertices(in, e, mesh);
    } else if (e.name == "face") {
      read_faces(in, e, mesh, path);
    } else {
      for (std::uint64_t i = 0; !e.properties.empty() && i < e.count; ++i)
        for (const Property& p : e.properties) skip_property(in, p);
    }
  }
  if (mesh.positions.empty()) in.fail("no vertices");
  return mesh;
}

}  // namespace retalho
