#include "retalho/render/tetraquad_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"

namespace retalho {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct Camera {
  Vec3 eye, forward, right, up;  ///< right and up are as long as half of the picture at distance 1
  Vec3 light;                    ///< towards it, unit

  Camera(Vec3 middle, double radius, double aspect, const TetraQuadPictureOptions& options) {
    const Vec3 axis = options.up == 'x' ? Vec3{1, 0, 0} : options.up == 'y' ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    const Vec3 east = options.up == 'x' ? Vec3{0, 1, 0} : options.up == 'y' ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    const Vec3 north = cross(axis, east);
    const double a = options.from * kDegree, e = options.elevation * kDegree;
    const Vec3 out = std::cos(e) * (std::sin(a) * east + std::cos(a) * north) + std::sin(e) * axis;
    const Vec3 side = std::cos(a) * east - std::sin(a) * north;  // never zero, also seen from straight above
    const double half = std::tan(options.field_of_view * kDegree / 2);
    eye = middle + radius * 1.05 / std::sin(options.field_of_view * kDegree / 2) * out;
    forward = -out;
    const Vec3 to_right = -side, to_up = cross(to_right, forward);
    right = half * std::max(aspect, 1.0) * to_right;
    up = half * std::max(1 / aspect, 1.0) * to_up;
    light = normalized(1.2 * out + 0.9 * to_up - 0.7 * to_right);
  }
};

struct Box {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
};

/// Of the tetrahedra that the surface passes through.
Box box_of(const TetraQuadField& field) {
  Box box;
  const TetMesh& mesh = field.surface().mesh;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (!field.may_cross(t)) continue;
    for (const std::uint32_t v : mesh.tets[t]) {
      const Vec3 p = mesh.position(v);
      box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
      box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
    }
  }
  return box;
}

/// The part of a ray that no cut plane takes away.
bool clip(const std::vector<CutPlane>& cuts, Vec3 origin, Vec3 direction, double& from, double& to) {
  for (const CutPlane& cut : cuts) {
    const double height = cut.offset - dot(cut.normal, origin), rise = dot(cut.normal, direction);
    if (rise > 0)
      to = std::min(to, height / rise);
    else if (rise < 0)
      from = std::max(from, height / rise);
    else if (height < 0)
      return false;
  }
  return from <= to;
}

class Painter {
 public:
  Painter(const TetraQuadField& field, const TetraQuadRays& rays, const TetraQuadPictureOptions& options,
          const Camera& camera)
      : field_(field), rays_(rays), options_(options), camera_(camera) {
    if (options.colors == TetraQuadColors::normal_jumps)
      faces_.emplace(field.surface().mesh.tets, field.surface().mesh.lattice.size());
  }

  /// Red, green, blue from 0 to 1.
  Vec3 color(double x, double y) const {
    const Vec3 direction = camera_.forward + x * camera_.right + y * camera_.up;
    double from = 0, to = HUGE_VAL;
    const Vec3 white = {1, 1, 1};
    if (!clip(options_.cuts, camera_.eye, direction, from, to)) return white;
    const auto hit = rays_.first(camera_.eye, direction, from, to);
    if (!hit) return white;
    const Vec3 gradient = field_.gradient(hit->tet, hit->b).gradient;
    const double length = norm(gradient);
    Vec3 normal = length > 0 ? gradient / length : Vec3{0, 0, 1};
    const bool outside = dot(normal, direction) < 0;
    if (!outside) normal = -normal;
    Vec3 paint = outside ? Vec3{0.86, 0.84, 0.79} : Vec3{0.80, 0.50, 0.33};
    if (faces_) {
      const double share = std::min(1.0, normal_jump(field_, *faces_, hit->tet, hit->b) / options_.largest_jump);
      paint = {0.95 - 0.1 * share, 0.95 - 0.8 * share, 0.93 - 0.8 * share};
    }
    if (options_.outlines && *std::min_element(hit->b.begin(), hit->b.end()) < 0.02) paint = 0.45 * paint;
    const double diffuse = std::max(0.0, dot(normal, camera_.light));
    const Vec3 half = normalized(camera_.light - normalized(direction));
    const double shine = 0.18 * std::pow(std::max(0.0, dot(normal, half)), 40);
    return (0.25 + 0.78 * diffuse) * paint + Vec3{shine, shine, shine};
  }

 private:
  const TetraQuadField& field_;
  const TetraQuadRays& rays_;
  const TetraQuadPictureOptions& options_;
  const Camera& camera_;
  std::optional<HalfFaces> faces_;
};

std::uint8_t to_byte(double linear) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(linear, 0.0, 1.0)));
}

void check(int width, int height, const TetraQuadPictureOptions& options) {
  if (width < 1 || height < 1 || width > 20000 || height > 20000)
    throw UsageError("a picture of 1 to 20000 pixels a side", {}, "--size");
  if (options.up != 'x' && options.up != 'y' && options.up != 'z') throw UsageError("--up is x, y or z", {}, "--up");
  if (!std::isfinite(options.from) || !(options.elevation >= -90 && options.elevation <= 90))
    throw UsageError("the eye stands from -90 to 90 degrees over the horizon", {}, "--elevation");
  if (!(options.field_of_view >= 1 && options.field_of_view <= 120))
    throw UsageError("a field of view of 1 to 120 degrees");
  if (options.samples < 1 || options.samples > 8) throw UsageError("1 to 8 samples a pixel's side");
  if (!(options.largest_jump > 0)) throw UsageError("the largest jump must be above 0");
}

}  // namespace

CutPlane parse_cut(const std::string& text, const Georef& georef) {
  CutPlane cut;
  double value = 0;
  const char* end = text.data() + text.size();
  const auto number = text.size() > 2 ? std::from_chars(text.data() + 2, end, value) : std::from_chars_result{};
  const bool axis = !text.empty() && text[0] >= 'x' && text[0] <= 'z';
  if (!axis || text.size() < 3 || (text[1] != '<' && text[1] != '>') || number.ec != std::errc{} || number.ptr != end ||
      !std::isfinite(value))
    throw UsageError(fmt::format("the cut '{}' is not an axis, < or >, and a number, such as 'x<0.5'", text), {},
                     "cut");
  if (text[0] == 'x') value = georef.to_local({value, 0}).x;
  if (text[0] == 'y') value = georef.to_local({0, value}).y;
  const double sign = text[1] == '<' ? 1 : -1;
  cut.normal = {text[0] == 'x' ? sign : 0, text[0] == 'y' ? sign : 0, text[0] == 'z' ? sign : 0};
  cut.offset = sign * value;
  return cut;
}

double normal_jump(const TetraQuadField& field, const HalfFaces& faces, std::size_t tet, const TetBarycentric& b) {
  const auto corner = static_cast<std::size_t>(std::min_element(b.begin(), b.end()) - b.begin());
  const std::int64_t other = faces.neighbour(tet, corner);
  if (other < 0) return 0;
  TetBarycentric here = b, there{};
  here[corner] = 0;
  double sum = 0;
  for (double& c : here) sum += c = std::max(0.0, c);
  const TetCorners& far = faces.corners(static_cast<std::size_t>(other));
  for (std::size_t i = 0; i < 4; ++i) {
    here[i] /= sum;
    const auto at = std::find(far.begin(), far.end(), faces.corners(tet)[i]);
    if (at != far.end()) there[static_cast<std::size_t>(at - far.begin())] = here[i];
  }
  const Vec3 a = field.gradient(tet, here).gradient,
             c = field.gradient(static_cast<std::size_t>(other), there).gradient;
  const double sine = norm(cross(a, c)), cosine = dot(a, c);
  return std::atan2(sine, cosine) / kDegree;
}

Image draw_tetraquad(const TetraQuadField& field, const TetraQuadRays& rays, int width, int height,
                     const TetraQuadPictureOptions& options, const Context& context) {
  check(width, height, options);
  const Box box = box_of(field);
  if (box.low.x > box.high.x) throw BadInput("the surface passes through no tetrahedron: there is nothing to draw");
  const Camera camera(0.5 * (box.low + box.high), 0.5 * norm(box.high - box.low), static_cast<double>(width) / height,
                      options);
  const Painter painter(field, rays, options, camera);
  Image image(width, height);
  const double samples = options.samples;
  parallel_chunks(static_cast<std::size_t>(height), 4, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (int column = 0; column < width; ++column) {
        Vec3 sum{};
        for (int i = 0; i < options.samples; ++i)
          for (int j = 0; j < options.samples; ++j)
            sum = sum + painter.color((column + (i + 0.5) / samples) / width * 2 - 1,
                                      1 - (static_cast<double>(row) + (j + 0.5) / samples) / height * 2);
        sum = sum / (samples * samples);
        image.at(column, static_cast<int>(row)) = {to_byte(sum.x), to_byte(sum.y), to_byte(sum.z)};
      }
  });
  return image;
}

}  // namespace retalho
