#include "retalho/render/patch_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/patch/joins.h"
#include "retalho/render/band_lists.h"
#include "retalho/render/color.h"

namespace retalho {
namespace {

constexpr int kSamples = 3;               ///< a side of a pixel
constexpr double kLine = 0.6 * kSamples;  ///< half of a side's line

struct Corner {
  Vec3 place, normal;  ///< x to the right, y up, z towards the eye
  Vec2 uv;
  double value = 0;
};

struct View {
  Vec3 right, up, towards;
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

/// A band of the picture's samples, y up: the rows [first, end). What lies in other rows is not drawn.
class Canvas {
 public:
  Canvas(int width, int first, int end)
      : width_(width), first_(first), end_(end), color_(size(), Color{1, 1, 1}), depth_(size(), -1e300) {}

  template <typename Shade>
  void triangle(const std::array<Corner, 3>& c, const Shade& shade) {
    const auto flat = [](const Corner& k) { return Vec2{k.place.x, k.place.y}; };
    const Vec2 a = flat(c[0]), b = flat(c[1]), d = flat(c[2]);
    const double area = cross(b - a, d - a);
    if (area == 0 || !std::isfinite(area)) return;
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x, b.x, d.x})))),
              x1 = std::min(width_ - 1, static_cast<int>(std::floor(std::max({a.x, b.x, d.x})))),
              y0 = std::max(first_, static_cast<int>(std::ceil(std::min({a.y, b.y, d.y})))),
              y1 = std::min(end_ - 1, static_cast<int>(std::floor(std::max({a.y, b.y, d.y}))));
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
          if (x < 0 || y < first_ || x >= width_ || y >= end_) continue;
          if ((x - p.x) * (x - p.x) + (y - p.y) * (y - p.y) > radius * radius) continue;
          if (depth_[index(x, y)] > p.z + slack) continue;
          color_[index(x, y)] = color;
        }
    }
  }

  /// Its pixels into the picture, whose samples have `height` rows.
  void put(Image& out, int height) const {
    for (int y = (height - end_) / kSamples; y < (height - first_) / kSamples; ++y)
      for (int x = 0; x < out.width; ++x) {
        Color sum;
        for (int j = 0; j < kSamples; ++j)
          for (int i = 0; i < kSamples; ++i)
            sum = sum + color_[index(x * kSamples + i, height - 1 - (y * kSamples + j))];
        out.at(x, y) = to_rgb((1.0 / (kSamples * kSamples)) * sum);
      }
  }

 private:
  std::size_t size() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(end_ - first_); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - first_) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_, first_, end_;
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

/// What is drawn of one patch: its places are in the picture's samples.
struct Sheet {
  std::vector<Corner> corners;
  Domain domain;
};

/// Heights of `values` that 95 of 100 are below; 1 where there are none.
double usual_range(std::vector<double>& values) {
  if (values.empty()) return 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at > 0 ? *at : 1;
}

/// The patches cut finely, seen by the view, and the range of their curvatures.
std::vector<Sheet> cut_finely(std::span<const Patch> patches, std::span<const PatchSurface> surfaces,
                              const PatchPictureOptions& options, double& range, const Context& context) {
  const View view = look(options.from, options.elevation);
  std::vector<Sheet> sheets(patches.size());
  std::vector<double> values;
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  for (std::size_t i = 0; i < patches.size(); ++i) {
    context.check();
    const std::size_t side =
        static_cast<std::size_t>(std::sqrt(static_cast<double>(patches[i].domain.triangles.size())));
    Patch fine = refine(patches[i], surfaces[i], std::clamp<std::size_t>(192 / std::max<std::size_t>(side, 1), 1, 64));
    sheets[i].corners.reserve(fine.positions.size());
    for (std::size_t k = 0; k < fine.positions.size(); ++k) {
      if (k % 1024 == 0) context.check();
      const Vec3 p = fine.positions[k];
      const Vec2 uv = fine.domain.parameters[k];
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
      sheets[i].corners.push_back(c);
    }
    sheets[i].domain = std::move(fine.domain);
  }
  range = usual_range(values);
  const double width = options.width * kSamples, height = options.height * kSamples;
  const double scale =
      0.92 * std::min(width / std::max(high.x - low.x, 1e-300), height / std::max(high.y - low.y, 1e-300));
  const Vec3 middle{(low.x + high.x) / 2, (low.y + high.y) / 2, 0}, centre{width / 2, height / 2, 0};
  for (Sheet& sheet : sheets)
    for (Corner& c : sheet.corners) c.place = centre + scale * (c.place - middle);
  return sheets;
}

/// A triangle, or an edge of a side, by its patch and its number there.
struct Piece {
  std::uint32_t sheet, first, second;  ///< of an edge: its ends; of a triangle: its number twice
};

/// Puts all triangles, and with `sides` the edges of the sides, once.
void put_all(const std::vector<Sheet>& sheets, bool sides, BandLists<Piece>& triangles, BandLists<Piece>& edges,
             const Context& context) {
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    context.check();
    const auto sheet = static_cast<std::uint32_t>(i);
    const auto y = [&](std::uint32_t v) { return sheets[i].corners[v].place.y; };
    const Domain& domain = sheets[i].domain;
    for (std::uint32_t t = 0; t < domain.triangles.size(); ++t) {
      const auto& v = domain.triangles[t];
      const auto [low, high] = std::minmax({y(v[0]), y(v[1]), y(v[2])});
      triangles.put({sheet, t, t}, low, high);
    }
    if (!sides) continue;
    for (const auto& side : domain.sides)
      for (std::size_t k = 0; k + 1 < side.size(); ++k) {
        const auto [low, high] = std::minmax({y(side[k]), y(side[k + 1])});
        edges.put({sheet, side[k], side[k + 1]}, low - kLine, high + kLine);
      }
  }
}

void draw_triangle(const Sheet& sheet, const std::array<std::uint32_t, 3>& t, const Painter& painter, Canvas& canvas) {
  const std::array<Corner, 3> c = {sheet.corners[t[0]], sheet.corners[t[1]], sheet.corners[t[2]]};
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

}  // namespace

Image draw_patches(std::span<const Patch> patches, std::span<const PatchSurface> surfaces,
                   const PatchPictureOptions& options, const Context& context) {
  if (options.width < 16 || options.height < 16 || options.width > 20000 || options.height > 20000)
    throw UsageError("a picture has 16 to 20000 pixels a side", {}, "--size");
  if (patches.empty() || patches.size() != surfaces.size()) throw UsageError("there is no patch to draw");
  double range = 1;
  const std::vector<Sheet> sheets = cut_finely(patches, surfaces, options, range, context);
  const Painter painter(options, range);
  const int width = options.width * kSamples, height = options.height * kSamples;
  const int rows = kSamples * std::max(1, kBandSamples / (kSamples * width));
  BandLists<Piece> triangles(height, rows), edges(height, rows);
  put_all(sheets, options.sides, triangles, edges, context);
  triangles.turn();
  edges.turn();
  put_all(sheets, options.sides, triangles, edges, context);
  Image image(options.width, options.height);
  context.report("drawing", 0);
  parallel_chunks(triangles.count(), 1, context, [&](std::size_t band, std::size_t) {
    const auto [first, end] = triangles.rows(band);
    Canvas canvas(width, first, end);
    std::size_t drawn = 0;
    for (const Piece& p : triangles.of(band)) {
      if (++drawn % 1024 == 0) context.check();
      draw_triangle(sheets[p.sheet], sheets[p.sheet].domain.triangles[p.first], painter, canvas);
    }
    for (const Piece& p : edges.of(band)) {
      const std::vector<Corner>& corners = sheets[p.sheet].corners;
      canvas.line(corners[p.first].place, corners[p.second].place, kLine, 2.0 * kSamples, {0.10, 0.13, 0.20});
    }
    canvas.put(image, height);
  });
  context.report("drawing", 1);
  return image;
}

}  // namespace retalho
