#include "tetraquad_calls.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <mutex>

#include "retalho/core/error.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/model/model.h"
#include "retalho/tetraquad/document.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/rays.h"
#include "retalho/tetraquad/tetraquad.h"
#include "saved_file.h"

namespace retalho::viewer {
namespace {

/// A surface with its ray caster. The page's coordinates are edges of the (largest) cubes from the middle of the box.
struct Loaded {
  std::string key;
  std::shared_ptr<const TetraQuad> surface;
  std::unique_ptr<TetraQuadField> field;
  std::unique_ptr<TetraQuadRays> rays;
  Vec3 middle;

  /// Steps of the lattice to an edge of a cube: adaptive meshes have many.
  double steps() const { return surface->mesh.forest ? static_cast<double>(TetForest::kUnit) : 1; }
  double unit() const { return steps() * surface->mesh.step; }
  Vec3 to_page(Vec3 p) const { return (p - middle) / unit(); }
  Vec3 from_page(Vec3 p) const { return middle + unit() * p; }
};
using LoadedPointer = std::shared_ptr<const Loaded>;

class Surfaces {
 public:
  explicit Surfaces(const InputFiles& inputs) : inputs_(inputs.tetraquads), clouds_(inputs.clouds) {}

  const std::vector<TetraQuadInput>& inputs() const { return inputs_; }
  const std::vector<CloudInput>& clouds() const { return clouds_; }

  /// {"cloud": k, "resolution": n}: fits, and keeps the surface for load().
  TetraQuadFitReport reconstruct(const Json& input, const Context& context) {
    const Made wanted = made_of(input);
    TetraQuadFitReport report;
    TetraQuad surface =
        fit_tetraquad(*clouds_[wanted.cloud].cloud, {.resolution = wanted.resolution}, &report, context);
    const std::lock_guard lock(mutex_);
    made_.push_front({wanted, std::make_shared<const TetraQuad>(std::move(surface))});
    if (made_.size() > kMostMade) made_.pop_back();
    return report;
  }

  /// {"file": k} or {"document": {...}}; the last one is kept.
  LoadedPointer load(const Json& input, const Context& context) {
    const bool written = input.contains("document");
    if (input.contains("cloud")) {
      const Made wanted = made_of(input);
      return keep(fmt::format("cloud {} {}", wanted.cloud, wanted.resolution), find_made(wanted), context);
    }
    const std::size_t file =
        written ? 0 : static_cast<std::size_t>(whole(input, "file", 0, static_cast<std::int64_t>(inputs_.size()) - 1));
    const std::string key = written ? input.at("document").dump() : fmt::format("file {}", file);
    return keep(key, written ? nullptr : inputs_[file].surface, context);
  }

 private:
  struct Made {
    std::size_t cloud = 0;
    int resolution = 0;
    friend bool operator==(const Made&, const Made&) = default;
  };
  static constexpr std::size_t kMostMade = 6;

  Made made_of(const Json& input) const {
    return {static_cast<std::size_t>(whole(input, "cloud", 0, static_cast<std::int64_t>(clouds_.size()) - 1)),
            static_cast<int>(whole(input, "resolution", 2, 64))};
  }

  std::shared_ptr<const TetraQuad> find_made(const Made& wanted) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [made, surface] : made_)
      if (made == wanted) return surface;
    throw BadInput("this reconstruction is no longer kept: make it again", {}, "resolution");
  }

  /// `given` is null for a document, which is its own key.
  LoadedPointer keep(const std::string& key, std::shared_ptr<const TetraQuad> given, const Context& context) {
    const std::lock_guard lock(mutex_);
    if (last_ && last_->key == key) return last_;
    auto loaded = std::make_shared<Loaded>();
    loaded->key = key;
    loaded->surface = given ? std::move(given) : std::make_shared<const TetraQuad>(parse_quadrics(key, "the document"));
    const TetMesh& mesh = loaded->surface->mesh;
    if (mesh.tets.size() > kMostTets)
      throw BadInput(fmt::format("{} tetrahedra are more than the page draws ({})", mesh.tets.size(), kMostTets));
    loaded->field = std::make_unique<TetraQuadField>(*loaded->surface);
    loaded->rays = std::make_unique<TetraQuadRays>(*loaded->field, 6, context);
    Vec3 low = mesh.position(0), high = low;
    for (std::size_t v = 0; v < mesh.lattice.size(); ++v) {
      const Vec3 p = mesh.position(v);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    loaded->middle = 0.5 * (low + high);
    last_ = loaded;
    return last_;
  }

  std::vector<TetraQuadInput> inputs_;
  std::vector<CloudInput> clouds_;
  mutable std::mutex mutex_;
  std::deque<std::pair<Made, std::shared_ptr<const TetraQuad>>> made_;
  LoadedPointer last_;
};

void push(std::vector<float>& to, Vec3 p) {
  for (const double v : {p.x, p.y, p.z}) to.push_back(static_cast<float>(v));
}

Json place(Vec3 p) {
  return {p.x, p.y, p.z};
}

/// Vertices, the ten factors of each one's quadric (about itself), both in the page's coordinates, and the tetrahedra
/// that the surface may cross, turned so that their corners are right-handed.
Answer load_call(Surfaces& surfaces, const Json& input, const Context& context) {
  const LoadedPointer loaded = surfaces.load(input, context);
  const TetraQuad& surface = *loaded->surface;
  const TetMesh& mesh = surface.mesh;
  std::vector<float> vertices, quadrics;
  std::vector<Vec3> at;
  for (std::size_t v = 0; v < mesh.lattice.size(); ++v) {
    at.push_back(loaded->to_page(mesh.position(v)));
    push(vertices, at.back());
    // Values are lengths: in another unit the constant is divided by it, and what is of second degree is multiplied.
    for (std::size_t k = 0; k < 10; ++k)
      quadrics.push_back(static_cast<float>(surface.quadrics[v][k] * std::pow(loaded->steps(), k == 0  ? -1
                                                                                               : k < 4 ? 0
                                                                                                       : 1)));
  }
  std::vector<std::uint32_t> tets, crossed;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    std::array<std::uint32_t, 4> c{};
    for (std::size_t k = 0; k < 4; ++k) c[k] = mesh.tets[t][k];
    const Vec3 a = at[c[1]] - at[c[0]], b = at[c[2]] - at[c[0]], d = at[c[3]] - at[c[0]];
    if (dot(a, cross(b, d)) < 0) std::swap(c[2], c[3]);
    tets.insert(tets.end(), c.begin(), c.end());
    if (loaded->field->may_cross(t)) crossed.push_back(static_cast<std::uint32_t>(t));
  }
  Json lattice = Json::array();
  if (mesh.lattice.size() <= 400)  // few enough to choose one by hand
    for (const LatticePoint& l : mesh.lattice) lattice.push_back({l[0], l[1], l[2]});
  return {{{"vertices", mesh.lattice.size()},
           {"tetrahedra", mesh.tets.size()},
           {"crossed", crossed.size()},
           {"step", loaded->unit()},
           {"middle", place(loaded->middle)},
           {"lattice", lattice}},
          {make_array("vertices", vertices), make_array("quadrics", quadrics), make_array("tets", tets),
           make_array("crossed", crossed)}};
}

Vec3 vector_of(const Json& input, const char* key) {
  const auto at = input.find(key);
  if (at == input.end() || !at->is_array() || at->size() != 3 ||
      !std::all_of(at->begin(), at->end(), [](const Json& v) { return v.is_number(); }))
    throw BadInput(fmt::format("'{}' must be three numbers", key), {}, key);
  return {(*at)[0].get<double>(), (*at)[1].get<double>(), (*at)[2].get<double>()};
}

/// The first hit of a ray given in the page's coordinates, from `from` on, by the program's ray caster.
Answer ray_call(Surfaces& surfaces, const Json& input, const Context& context) {
  const LoadedPointer loaded = surfaces.load(input, context);
  const Vec3 origin = loaded->from_page(vector_of(input, "origin")), direction = vector_of(input, "direction");
  const double from = number_or(input, "from", 0, 1e9, 0), to = number_or(input, "to", 0, 1e9, 1e9);
  const Vec3 way = loaded->unit() * direction;
  const auto hit = loaded->rays->first(origin, way, from, to);
  if (!hit) return {{{"hit", false}}};
  const Vec3 point = origin + hit->t * way;
  const Jet3 jet = loaded->field->gradient(hit->tet, hit->b);
  const Vec3 gradient = jet.gradient;
  return {{{"hit", true},
           {"t", hit->t},
           {"page_point", place(loaded->to_page(point))},
           {"point", place(point)},
           {"normal", norm(gradient) > 0 ? place(normalized(gradient)) : Json(nullptr)},
           {"cell", loaded->surface->mesh.size(hit->tet) / loaded->steps()},
           {"tet", hit->tet}}};
}

/// Triangles as `retalho mesh` makes them when it is given no tolerance; or the model file.
Answer save_call(Surfaces& surfaces, const Json& input, const Context& context) {
  const std::string format = save_format(input);
  const LoadedPointer loaded = surfaces.load(input, context);
  if (format == "retalho") return saved_model(encode_model(*loaded->surface));
  return saved_mesh(mesh_tetraquad(*loaded->field, {}, nullptr, context), format);
}

}  // namespace

void add_tetraquad_calls(CallTable& table, const InputFiles& inputs) {
  const auto surfaces = std::make_shared<Surfaces>(inputs);
  table["/api/tetraquads/files"] = {Call::Kind::quick, [surfaces](const Json&, const Context&) {
                                      Json list = Json::array();
                                      for (const TetraQuadInput& one : surfaces->inputs())
                                        list.push_back({{"name", one.name}, {"described", one.described}});
                                      Json clouds = Json::array();
                                      for (const CloudInput& one : surfaces->clouds())
                                        clouds.push_back({{"name", one.name}, {"described", one.described}});
                                      return Answer{{{"files", list}, {"clouds", clouds}}};
                                    }};
  table["/api/tetraquads/reconstruct"] = {Call::Kind::slow, [surfaces](const Json& input, const Context& context) {
                                            const TetraQuadFitReport report = surfaces->reconstruct(input, context);
                                            return Answer{{{"points", report.points},
                                                           {"used", report.used},
                                                           {"vertices", report.vertices},
                                                           {"tetrahedra", report.tetrahedra},
                                                           {"coefficients", report.coefficients},
                                                           {"residual_mean", report.residual_mean},
                                                           {"residual_max", report.residual_max},
                                                           {"warnings", report.warnings}}};
                                          }};
  table["/api/tetraquads/load"] = {Call::Kind::quick, [surfaces](const Json& input, const Context& context) {
                                     return load_call(*surfaces, input, context);
                                   }};
  table["/api/tetraquads/save"] = {Call::Kind::slow, [surfaces](const Json& input, const Context& context) {
                                     return save_call(*surfaces, input, context);
                                   }};
  table["/api/tetraquads/ray"] = {Call::Kind::quick, [surfaces](const Json& input, const Context& context) {
                                    return ray_call(*surfaces, input, context);
                                  }};
}

}  // namespace retalho::viewer
