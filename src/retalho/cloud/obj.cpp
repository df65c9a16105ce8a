// OBJ as points: its vertices ("v"), and normals ("vn") where faces or an equal number say whose they are.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "retalho/cloud/formats.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr std::string_view kBlank = " \t\r";

/// The next word of `line`, taken off it; empty at the end.
std::string_view next_word(std::string_view& line) {
  const std::size_t from = line.find_first_not_of(kBlank);
  if (from == std::string_view::npos) return line = {};
  const std::size_t to = std::min(line.find_first_of(kBlank, from), line.size());
  const std::string_view word = line.substr(from, to - from);
  line.remove_prefix(to);
  return word;
}

class ObjReader {
 public:
  ObjReader(const std::string& name, PointCloud& cloud, PointNotes& notes)
      : name_(name), cloud_(cloud), notes_(notes) {}

  void line(std::string_view text) {
    ++line_;
    text = text.substr(0, text.find('#'));
    const std::string_view word = next_word(text);
    if (word == "v")
      places_.push_back(vector(text, "v"));
    else if (word == "vn")
      normals_.push_back(vector(text, "vn"));
    else if (word == "f" || word == "p" || word == "l")
      face(text);
  }

  void finish() {
    const bool by_faces = !sums_.empty(), by_number = !by_faces && normals_.size() == places_.size();
    const bool with_normals = !normals_.empty() && (by_faces || by_number);
    sums_.resize(places_.size());
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Vec3 p = places_[i];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        ++notes_.skipped;
        continue;
      }
      cloud_.positions.push_back(p);
      if (with_normals) cloud_.normals.push_back(by_faces ? sums_[i] : normals_[i]);
    }
    if (!normals_.empty() && !with_normals)
      notes_.remarks.push_back(
          fmt::format("{} normals for {} vertices, and no face says whose they are: they are not used", normals_.size(),
                      places_.size()));
    notes_.format = "OBJ";
    notes_.columns = with_normals ? "x, y, z, normals" : "x, y, z";
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw CannotRead(fmt::format("'{}', line {}: {}", name_, line_, what), name_);
  }
  Vec3 vector(std::string_view text, const char* what) const {
    double value[3]{};
    for (double& v : value) {
      const std::string_view word = next_word(text);
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v);
      if (word.empty() || error == std::errc::invalid_argument || end != word.data() + word.size())
        fail(fmt::format("'{}' wants three numbers, and '{}' is none", what, word));
      if (error == std::errc::result_out_of_range) v = std::nan("");
    }
    return {value[0], value[1], value[2]};
  }
  /// Gives each vertex of a face the normal that stands with it: v//n or v/t/n, counted from 1, or back from -1.
  void face(std::string_view text) {
    for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) {
      const std::size_t vertex = index(word.substr(0, word.find('/')), places_.size(), "vertex");
      const std::size_t slash = word.rfind('/');
      if (slash == std::string_view::npos || slash == word.find('/') || slash + 1 == word.size()) continue;
      const std::size_t normal = index(word.substr(slash + 1), normals_.size(), "normal");
      if (sums_.size() < places_.size()) sums_.resize(places_.size());
      sums_[vertex] = sums_[vertex] + normals_[normal];
    }
  }
  std::size_t index(std::string_view word, std::size_t count, const char* what) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const std::int64_t n = static_cast<std::int64_t>(count), at = value < 0 ? n + value : value - 1;
    if (error != std::errc{} || end != word.data() + word.size() || value == 0 || at < 0 || at >= n)
      fail(fmt::format("'{}' is no {} (there are {} so far)", word, what, count));
    return static_cast<std::size_t>(at);
  }

  const std::string& name_;
  PointCloud& cloud_;
  PointNotes& notes_;
  std::size_t line_ = 0;
  std::vector<Vec3> places_, normals_, sums_;
};

}  // namespace

void parse_obj_points(const std::string& text, const std::string& name, PointCloud& cloud, PointNotes& notes,
                      const Context& context) {
  ObjReader reader(name, cloud, notes);
  std::size_t lines = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    reader.line(std::string_view(text).substr(at, end - at));
    at = end + 1;
    if (++lines % 65536 == 0) context.check();
  }
  reader.finish();
}

void read_obj_points(const std::string& path, PointCloud& cloud, PointNotes& notes, const Context& context) {
  parse_obj_points(read_file(path), path, cloud, notes, context);
}

}  // namespace retalho
