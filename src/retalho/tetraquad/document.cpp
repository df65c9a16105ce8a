#include "retalho/tetraquad/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

using Json = nlohmann::json;

constexpr std::array<const char*, 10> kTerms = {"1", "x", "y", "z", "xx", "yy", "zz", "xy", "xz", "yz"};

class Reader {
 public:
  Reader(const Json& root, std::string file) : root_(root), file_(std::move(file)) {}

  TetraQuad read() const {
    check_keys(root_, {"origin", "step", "split", "tetrahedra", "everywhere", "quadrics", "comment"}, "the document");
    const Vec3 origin = root_.contains("origin") ? vector(root_["origin"], "origin") : Vec3{};
    const double step = root_.contains("step") ? number(root_["step"], "step") : 1;
    if (!(step > 0)) fail("step", "must be above 0");
    const TetSplit split = read_split();
    std::vector<TetPlace> places;
    for (const Json& item : list("tetrahedra")) {
      if (!item.is_array() || item.size() != 4) fail("tetrahedra", "are [i, j, k, type] each");
      TetPlace place;
      for (std::size_t k = 0; k < 3; ++k) place.cell[k] = whole(item[k], "tetrahedra", -1000, 1000);
      place.type = static_cast<std::uint8_t>(whole(item[3], "tetrahedra", 0, tets_of_cube(split) - 1));
      places.push_back(place);
    }
    if (places.empty()) fail("tetrahedra", "must hold at least one [i, j, k, type]");
    TetraQuad surface;
    surface.mesh = make_tet_mesh(origin, step, split, std::move(places));
    std::vector<std::optional<Quadric>> quadrics(surface.mesh.lattice.size());
    if (root_.contains("everywhere"))
      for (std::size_t v = 0; v < quadrics.size(); ++v)
        quadrics[v] = quadric(root_["everywhere"], "everywhere", surface.mesh.position(v), step);
    for (const Json& item : root_.contains("quadrics") ? list("quadrics") : Json::array()) {
      if (!item.is_object() || !item.contains("vertex") || !item["vertex"].is_array() || item["vertex"].size() != 3)
        fail("quadrics", "need \"vertex\": [i, j, k] each");
      LatticePoint at{};
      for (std::size_t k = 0; k < 3; ++k) at[k] = whole(item["vertex"][k], "vertex", -1001, 1001);
      const auto found = std::find(surface.mesh.lattice.begin(), surface.mesh.lattice.end(), at);
      if (found == surface.mesh.lattice.end())
        fail("vertex", fmt::format("[{}, {}, {}] belongs to no tetrahedron", at[0], at[1], at[2]));
      const auto v = static_cast<std::size_t>(found - surface.mesh.lattice.begin());
      quadrics[v] = quadric(item, "quadrics", surface.mesh.position(v), step);
    }
    for (std::size_t v = 0; v < quadrics.size(); ++v) {
      const LatticePoint& l = surface.mesh.lattice[v];
      if (!quadrics[v]) fail("quadrics", fmt::format("vertex [{}, {}, {}] has none", l[0], l[1], l[2]));
      surface.quadrics.push_back(*quadrics[v]);
    }
    return surface;
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& words) const {
    throw BadInput(fmt::format("{}'{}' {}", file_.empty() ? "" : "'" + file_ + "': ", key, words), file_, key);
  }
  void check_keys(const Json& object, const std::vector<std::string>& known, const std::string& what) const {
    if (!object.is_object()) fail(what, "is not a JSON object");
    for (const auto& [key, value] : object.items())
      if (std::find(known.begin(), known.end(), key) == known.end()) fail(key, fmt::format("is no key of {}", what));
  }
  const Json& list(const char* key) const {
    if (!root_.contains(key) || !root_[key].is_array()) fail(key, "must be an array");
    return root_[key];
  }
  double number(const Json& value, const std::string& key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail(key, "must be a finite number");
    return value.get<double>();
  }
  int whole(const Json& value, const std::string& key, int least, int most) const {
    const double x = number(value, key);
    if (x != std::floor(x) || x < least || x > most)
      fail(key, fmt::format("holds {}: whole numbers from {} to {}", value.dump(), least, most));
    return static_cast<int>(x);
  }
  Vec3 vector(const Json& value, const std::string& key) const {
    if (!value.is_array() || value.size() != 3) fail(key, "must be [x, y, z]");
    return {number(value[0], key), number(value[1], key), number(value[2], key)};
  }
  TetSplit read_split() const {
    if (!root_.contains("split") || root_["split"] == "five") return TetSplit::five;
    if (root_["split"] != "kuhn") fail("split", "is \"five\" or \"kuhn\"");
    return TetSplit::kuhn;
  }
  /// From a polynomial in the coordinates to one in steps from the vertex, divided by the step.
  Quadric quadric(const Json& object, const std::string& key, Vec3 at, double step) const {
    std::vector<std::string> known(kTerms.begin(), kTerms.end());
    known.emplace_back("vertex");
    check_keys(object, known, key);
    Quadric q{};
    for (std::size_t n = 0; n < 10; ++n)
      if (object.contains(kTerms[n])) q[n] = number(object[kTerms[n]], kTerms[n]);
    Quadric r = q;
    r[0] = polar(q, at, at) / step;
    r[1] = q[1] + 2 * q[4] * at.x + q[7] * at.y + q[8] * at.z;
    r[2] = q[2] + 2 * q[5] * at.y + q[7] * at.x + q[9] * at.z;
    r[3] = q[3] + 2 * q[6] * at.z + q[8] * at.x + q[9] * at.y;
    for (std::size_t n = 4; n < 10; ++n) r[n] = q[n] * step;
    return r;
  }

  const Json& root_;
  std::string file_;
};

}  // namespace

TetraQuad parse_quadrics(const std::string& text, const std::string& file) {
  Json root;
  try {
    root = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw CannotRead(fmt::format("cannot read '{}': it is no JSON at byte {}", file, error.byte), file,
                     fmt::format("byte {}", error.byte));
  }
  return Reader(root, file).read();
}

TetraQuad read_quadrics(const std::string& path) {
  return parse_quadrics(read_file(path), path);
}

}  // namespace retalho
