#include "retalho/render/patch_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "retalho/core/error.h"
#include "retalho/patch/joins.h"
#include "retalho/render/color.h"

namespace retalho {
namespace {

constexpr int kSamples = 3;  ///< a side of a pixel

struct Corner {
  Vec3 place, normal;  ///< x to the right, y up, z towards the eye
  Vec2 uv;
  double value = 0;
};

struct View {
  Vec3 right, up, towards;
  Vec2 middle;
  double scale = 1;
};

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

View look(double from, double elevation) {
  const double a = radians(from), e = radians(elevation);
  View view;
  view.towards = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  view.right = {-std::sin(a), std::cos(a), 0};
  view.up = cross(view.towards, view.right);
  return view;
}

class Canvas {
 public:
  Canvas(int width, int height)
      : width_(width), height_(height), color_(size(), Color{1, 1, 1}), depth_(size(), -1e300) {}
  int width() const { return width_; }
  int height() const { return height_; }

  template <typename Shade>
  void triangle(const std::array<Corner, 3>& c, const Shade& shade) {
    const auto flat = [](const Corner& k) { return Vec2{k.place.x, k.place.y}; };
    const Vec2 a = flat(c[0]), b = flat(c[1]), d = flat(c[2]);
    const double area = cross(b - a, d - a);
    if (area == 0) return;
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x, b.x, d.x})))),
              x1 = std::min(width_ - 1, static_cast<int>(std::floor(std::max({a.x, b.x, d.x})))),
              y0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y, b.y, d.y})))),
              y1 = std::min(height_ - 1, static_cast<int>(std::floor(std::max({a.y, b.y, d.y}))));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const Vec2 p{static_cast<double>(x), static_cast<double>(y)};
        const double l0 = cross(b - p, d - p) / area, l1 = cross(d - p, a - p) / area, l2 = 1 - l0 - l1;
        if (l0 < -1e-9 || l1 < -1e-9 || l2 < -1e-9) continue;
        const double z = l0 * c[0].place.z + l1 * c[1].place.z + l2 * c[2].place.z;
        const std::size_t at = index(x, y);
        if (z <= depth_[at]) continue;
        depth_[at] = z;
        color_[at] = shade(std::array<double, 3>{l0, l1, l2});
      }
  }

  /// A line of `radius` samples, over surfaces that are not nearer by more than `slack`.
  void line(Vec3 a, Vec3 b, double radius, double slack, Color color) {
    const int steps = std::max(1, static_cast<int>(std::ceil(std::max(std::abs(b.x - a.x), std::abs(b.y - a.y)))));
    for (int k = 0; k <= steps; ++k) {
      const Vec3 p = a + (static_cast<double>(k) / steps) * (b - a);
      for (int y = static_cast<int>(std::ceil(p.y - radius)); y <= std::floor(p.y + radius); ++y)
        for (int x = static_cast<int>(std::ceil(p.x - radius)); x <= std::floor(p.x + radius); ++x) {
          if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
          if ((x - p.x) * (x - p.x) + (y - p.y) * (y - p.y) > radius * radius) continue;
          if (depth_[index(x, y)] > p.z + slack) continue;
          color_[index(x, y)] = color;
        }
    }
  }

  Image image() const {
    Image out(width_ / kSamples, height_ / kSamples);
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) {
        Color sum;
        for (int j = 0; j < kSamples; ++j)
          for (int i = 0; i < kSamples; ++i)
            sum = sum + color_[index(x * kSamples + i, height_ - 1 - (y * kSamples + j))];
        out.at(x, y) = to_rgb((1.0 / (kSamples * kSamples)) * sum);
      }
    return out;
  }

 private:
  std::size_t size() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_, height_;
  std::vector<Color> color_;
  std::vector<double> depth_;
};

/// One at the middle of a line of the family, 0 away from it; `width` in parameters.
double on_line(double value, int lines, double width) {
  const double at = value * lines, away = std::abs(at - std::nearbyint(at)) / lines;
  return std::clamp(1.5 - away / width, 0.0, 1.0);
}

class Painter {
 public:
  Painter(const PatchPictureOptions& options, double range) : options_(options), range_(range) {}

  Color operator()(Vec3 normal, Vec2 uv, double value, double line_width) const {
    const double length = norm(normal);
    Vec3 n = length > 0 ? normal / length : Vec3{0, 0, 1};
    if (n.z < 0) n = -n;
    static const Vec3 light = normalized({-0.4, 0.5, 0.8});
    const double facing = std::max(0.0, dot(n, light)), shade = 0.28 + 0.72 * facing;
    switch (options_.style) {
      case PatchStyle::shaded:
        return shade * kBody;
      case PatchStyle::lines: {
        const double w = 1 - uv.x - uv.y;
        const double ink =
            std::max({on_line(uv.x, options_.lines, line_width), on_line(uv.y, options_.lines, line_width),
                      on_line(w, options_.lines, line_width)});
        return shade * ((1 - 0.75 * ink) * kBody);
      }
      case PatchStyle::isophotes: {
        const double bands = std::acos(std::clamp(dot(n, light), -1.0, 1.0)) * 18;
        return (std::fmod(bands, 2) < 1 ? 0.55 : 1.0) * (shade * kBody);
      }
      case PatchStyle::zebra: {
        const Vec3 reflected = 2 * n.z * n - Vec3{0, 0, 1};
        const double stripes = std::asin(std::clamp(reflected.x, -1.0, 1.0)) * 12 / std::numbers::pi;
        return std::fmod(std::abs(stripes) + 0.5, 2) < 1 ? Color{0.95, 0.95, 0.95} : Color{0.12, 0.12, 0.14};
      }
      case PatchStyle::gaussian:
      case PatchStyle::mean:
        break;
    }
    return (0.55 + 0.45 * facing) * ramp_color(ColorRamp::diverging, 0.5 + 0.5 * std::clamp(value / range_, -1.0, 1.0));
  }

 private:
  static constexpr Color kBody{0.72, 0.80, 0.88};
  const PatchPictureOptions& options_;
  double range_;
};

}  // namespace

Image draw_patches(std::span<const Patch> patches, std::span<const PatchSurface> surfaces,
                   const PatchPictureOptions& options, const Context& context) {
  if (options.width < 16 || options.height < 16 || options.width > 20000 || options.height > 20000)
    throw UsageError("a picture has 16 to 20000 pixels a side", {}, "--size");
  if (patches.empty() || patches.size() != surfaces.size()) throw UsageError("there is no patch to draw");
  View view = look(options.from, options.elevation);
  std::vector<std::vector<Corner>> corners(patches.size());
  std::vector<Patch> fine;
  std::vector<double> values;
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  for (std::size_t i = 0; i < patches.size(); ++i) {
    context.check();
    const std::size_t side =
        static_cast<std::size_t>(std::sqrt(static_cast<double>(patches[i].domain.triangles.size())));
    fine.push_back(
        refine(patches[i], surfaces[i], std::clamp<std::size_t>(192 / std::max<std::size_t>(side, 1), 1, 64)));
    for (std::size_t k = 0; k < fine[i].positions.size(); ++k) {
      const Vec3 p = fine[i].positions[k];
      const Vec2 uv = fine[i].domain.parameters[k];
      const PatchJet jet = surfaces[i].full_jet(uv);
      Corner c;
      c.place = {dot(p, view.right), dot(p, view.up), dot(p, view.towards)};
      c.normal = {dot(jet.normal, view.right), dot(jet.normal, view.up), dot(jet.normal, view.towards)};
      c.uv = uv;
      if (options.style >= PatchStyle::gaussian) {
        const PatchCurvature curvature = surfaces[i].curvature(uv);
        c.value = options.style == PatchStyle::gaussian ? curvature.gaussian : curvature.mean;
        values.push_back(std::abs(c.value));
      }
      low = {std::min(low.x, c.place.x), std::min(low.y, c.place.y)};
      high = {std::max(high.x, c.place.x), std::max(high.y, c.place.y)};
      corners[i].push_back(c);
    }
  }
  double range = 1;
  if (!values.empty()) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    range = *at > 0 ? *at : 1;
  }
  Canvas canvas(options.width * kSamples, options.height * kSamples);
  view.scale = 0.92 * std::min(canvas.width() / std::max(high.x - low.x, 1e-300),
                               canvas.height() / std::max(high.y - low.y, 1e-300));
  const Vec3 middle{(low.x + high.x) / 2, (low.y + high.y) / 2, 0};
  const Vec3 centre{canvas.width() / 2.0, canvas.height() / 2.0, 0};
  const Painter painter(options, range);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    context.report("drawing", static_cast<double>(i) / static_cast<double>(patches.size()));
    for (Corner& c : corners[i]) c.place = centre + view.scale * (c.place - middle);
    for (const auto& t : fine[i].domain.triangles) {
      const std::array<Corner, 3> c = {corners[i][t[0]], corners[i][t[1]], corners[i][t[2]]};
      // Parameters a sample: so lines are equally wide wherever they run.
      const double span = std::sqrt(std::abs(cross(c[1].uv - c[0].uv, c[2].uv - c[0].uv)));
      const Vec3 e = c[1].place - c[0].place, f = c[2].place - c[0].place;
      const double pixels = std::sqrt(norm(cross(e, f)));
      const double line_width = pixels > 0 ? 1.3 * span / pixels : 1;
      canvas.triangle(c, [&](const std::array<double, 3>& l) {
        return painter(l[0] * c[0].normal + l[1] * c[1].normal + l[2] * c[2].normal,
                       l[0] * c[0].uv + l[1] * c[1].uv + l[2] * c[2].uv,
                       l[0] * c[0].value + l[1] * c[1].value + l[2] * c[2].value, line_width);
      });
    }
  }
  if (options.sides)
    for (std::size_t i = 0; i < patches.size(); ++i)
      for (const auto& side : fine[i].domain.sides)
        for (std::size_t k = 0; k + 1 < side.size(); ++k)
          canvas.line(corners[i][side[k]].place, corners[i][side[k + 1]].place, 0.6 * kSamples, 2.0 * kSamples,
                      {0.10, 0.13, 0.20});
  return canvas.image();
}

}  // namespace retalho
