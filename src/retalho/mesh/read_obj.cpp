// Wavefront OBJ: v, vt, vn and f (positive and negative numbers); everything else is passed over.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"

namespace retalho {
namespace {

constexpr std::uint32_t kUnset = 0xffffffffU;

/// A face's corner: 0-based numbers; kUnset where it has none.
struct Corner {
  std::uint32_t position = kUnset, texture = kUnset, normal = kUnset;
};

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  TriangleMesh read() {
    while (!bytes_.empty()) {
      const std::size_t end = std::min(bytes_.find('\n'), bytes_.size());
      rest_ = bytes_.substr(0, end);
      bytes_.remove_prefix(std::min(end + 1, bytes_.size()));
      ++line_;
      read_line();
    }
    if (mesh_.positions.empty())
      throw CannotRead(fmt::format("'{}' is not an OBJ file: it has no vertices", path_), path_);
    keep_attributes();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& words) const {
    throw BadInput(fmt::format("'{}', line {}: {}", path_, line_, words), path_, fmt::format("line {}", line_));
  }

  std::string_view word() {
    const std::size_t begin = std::min(rest_.find_first_not_of(" \t\r"), rest_.size());
    rest_.remove_prefix(begin);
    const std::size_t end = std::min(rest_.find_first_of(" \t\r"), rest_.size());
    const std::string_view w = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return w;
  }

  double number(const char* what) {
    std::string_view w = word();
    if (w.starts_with('+')) w.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (w.empty() || error != std::errc() || end != w.data() + w.size() || !std::isfinite(value))
      fail(fmt::format("'{}' is not the {} of a vertex", w, what));
    return value;
  }

  /// The number at the front of `w` as a 0-based index below `count`; nullopt where there is none.
  std::optional<std::uint32_t> index(std::string_view& w, std::size_t count, const char* what) {
    const std::size_t end = std::min(w.find('/'), w.size());
    const std::string_view digits = w.substr(0, end);
    w.remove_prefix(std::min(end + 1, w.size()));
    if (digits.empty()) return std::nullopt;
    std::int64_t i = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), i);
    if (error != std::errc() || stop != digits.data() + digits.size())
      fail(fmt::format("'{}' is not the number of a {}", digits, what));
    const auto n = static_cast<std::int64_t>(count);
    if (i == 0 || i > n || i < -n) fail(fmt::format("the face names {} {} of {}", what, i, n));
    return static_cast<std::uint32_t>(i > 0 ? i - 1 : n + i);
  }

  void read_line() {
    const std::string_view keyword = word();
    if (keyword == "v") {
      const double x = number("x"), y = number("y"), z = number("z");
      mesh_.positions.push_back({x, y, z});
    } else if (keyword == "vt") {
      const double s = number("texture coordinate");
      texture_.push_back({s, word_left() ? number("texture coordinate") : 0.0});
    } else if (keyword == "vn") {
      const double x = number("normal"), y = number("normal"), z = number("normal");
      normals_.push_back({x, y, z});
    } else if (keyword == "f") {
      read_face();
    }
  }

  bool word_left() const { return rest_.find_first_not_of(" \t\r") != std::string_view::npos; }

  void read_face() {
    corners_.clear();
    while (word_left()) {
      std::string_view w = word();
      Corner corner;
      const auto position = index(w, mesh_.positions.size(), "vertex");
      if (!position) fail("a corner without a vertex");
      corner.position = *position;
      corner.texture = index(w, texture_.size(), "texture coordinate").value_or(kUnset);
      corner.normal = index(w, normals_.size(), "normal").value_or(kUnset);
      corners_.push_back(corner);
    }
    if (corners_.size() < 3) fail(fmt::format("a face of {} corners", corners_.size()));
    for (std::size_t k = 1; k + 1 < corners_.size(); ++k)
      mesh_.triangles.push_back({corners_[0].position, corners_[k].position, corners_[k + 1].position});
    for (const Corner& c : corners_) {
      note(texture_of_, c.position, c.texture, one_texture_);
      note(normal_of_, c.position, c.normal, one_normal_);
    }
  }

  void note(std::vector<std::uint32_t>& of, std::uint32_t vertex, std::uint32_t value, bool& one) {
    if (of.size() < mesh_.positions.size()) of.resize(mesh_.positions.size(), kUnset);
    if (value == kUnset || (of[vertex] != kUnset && of[vertex] != value)) one = false;
    of[vertex] = value;
  }

  /// Normals and texture coordinates as one a vertex, where the faces use them so.
  template <typename Value>
  void keep(const std::vector<Value>& values, const std::vector<std::uint32_t>& of, bool one,
            std::vector<Value>& into) const {
    if (values.empty() || !one || of.empty()) return;
    into.resize(mesh_.positions.size());
    for (std::size_t v = 0; v < of.size(); ++v)
      if (of[v] != kUnset) into[v] = values[of[v]];
  }
  void keep_attributes() {
    keep(texture_, texture_of_, one_texture_, mesh_.texture);
    keep(normals_, normal_of_, one_normal_, mesh_.normals);
  }

  std::string_view bytes_, rest_;
  const std::string& path_;
  std::size_t line_ = 0;
  TriangleMesh mesh_;
  std::vector<Vec2> texture_;
  std::vector<Vec3> normals_;
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> texture_of_, normal_of_;
  bool one_texture_ = true, one_normal_ = true;
};

}  // namespace

TriangleMesh read_obj(std::string_view bytes, const std::string& path) {
  return ObjReader(bytes, path).read();
}

}  // namespace retalho
