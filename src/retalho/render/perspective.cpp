#include "retalho/render/perspective.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "retalho/core/parallel.h"
#include "retalho/render/band_lists.h"

namespace retalho {
namespace {

constexpr int kSamples = 2;           // a side of a pixel
constexpr double kCellsAPixel = 1.5;  // surface samples across the picture's longer side, a pixel
constexpr int kMostCells = 3000;      // and at most this many
constexpr double kDistance = 2.5;     // of the eye from the middle, in half diagonals of the block
constexpr double kWallBrightness = 0.45;

/// Screen coordinates (x right, y down) and nearness (1 / distance, which is linear on the screen).
struct ScreenPoint {
  double x = 0, y = 0, nearness = 0;
};

/// A pinhole camera that looks at the middle of a block.
class Camera {
 public:
  Camera(Vec3 middle, double radius, double from, double elevation) {
    const double a = from * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
    const Vec3 towards_eye{std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
    eye_ = middle + kDistance * radius * towards_eye;
    forward_ = -towards_eye;
    right_ = normalized(cross(forward_, Vec3{0, 0, 1}));
    up_ = cross(right_, forward_);
  }
  ScreenPoint project(Vec3 p) const {
    const Vec3 d = p - eye_;
    const double nearness = 1 / dot(d, forward_);
    return {dot(d, right_) * nearness, -dot(d, up_) * nearness, nearness};
  }

 private:
  Vec3 eye_, forward_, right_, up_;
};

/// Colours with a z-buffer, of a band of the picture's samples: the rows [first, end).
struct Canvas {
  int width, first, end;
  std::vector<float> nearness;
  std::vector<std::array<float, 3>> colors;

  Canvas(int w, int from, int to)
      : width(w),
        first(from),
        end(to),
        nearness(static_cast<std::size_t>(w) * static_cast<std::size_t>(to - from), 0.0F),
        colors(nearness.size(), {1.0F, 1.0F, 1.0F}) {}

  void triangle(const std::array<ScreenPoint, 3>& p, const std::array<Color, 3>& c) {
    const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    if (area == 0 || !std::isfinite(area)) return;
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
    const int x0 = std::max(0, static_cast<int>(std::ceil(left - 0.5)));
    const int x1 = std::min(width - 1, static_cast<int>(std::floor(right - 0.5)));
    const int y0 = std::max(first, static_cast<int>(std::ceil(top - 0.5)));
    const int y1 = std::min(end - 1, static_cast<int>(std::floor(bottom - 0.5)));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double px = x + 0.5, py = y + 0.5;
        const double r = ((p[1].x - px) * (p[2].y - py) - (p[1].y - py) * (p[2].x - px)) / area;
        const double s = ((p[2].x - px) * (p[0].y - py) - (p[2].y - py) * (p[0].x - px)) / area;
        const double t = 1 - r - s;
        if (r < 0 || s < 0 || t < 0) continue;
        const auto near = static_cast<float>(r * p[0].nearness + s * p[1].nearness + t * p[2].nearness);
        const std::size_t i = index(x, y);
        if (near <= nearness[i]) continue;
        nearness[i] = near;
        const Color mix = r * c[0] + s * c[1] + t * c[2];
        colors[i] = {static_cast<float>(mix.r), static_cast<float>(mix.g), static_cast<float>(mix.b)};
      }
  }

  void quad(const std::array<ScreenPoint, 4>& p, const std::array<Color, 4>& c) {
    triangle({p[0], p[1], p[2]}, {c[0], c[1], c[2]});
    triangle({p[0], p[2], p[3]}, {c[0], c[2], c[3]});
  }

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - first) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }

  /// Its pixels into the picture.
  void put(Image& image) const {
    for (int y = first / kSamples; y < end / kSamples; ++y)
      for (int x = 0; x < image.width; ++x) {
        Color sum;
        for (int k = 0; k < kSamples * kSamples; ++k) {
          const auto& c = colors[index(x * kSamples + k % kSamples, y * kSamples + k / kSamples)];
          sum = sum + Color{c[0], c[1], c[2]};
        }
        image.at(x, y) = to_rgb(1.0 / (kSamples * kSamples) * sum);
      }
  }
};

/// The surface's samples, seen by the camera and scaled into the canvas.
struct Scene {
  int columns = 0, rows = 0;
  std::vector<ScreenPoint> top, foot;  ///< of each sample; without data: nearness 0
  std::vector<Color> colors;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  bool data(std::size_t i) const { return top[i].nearness > 0; }
};

Window sample_window(const Georef& georef, const Extent& extent, int width, int height) {
  const double most = std::max(extent.width(), extent.height());
  const int cells = std::min(kMostCells, static_cast<int>(kCellsAPixel * std::max(width, height)));
  const double step = most > 0 ? most / cells : 1;
  const int columns = std::max(1, static_cast<int>(std::round(extent.width() / step)));
  const int rows = std::max(1, static_cast<int>(std::round(extent.height() / step)));
  return {
      georef, {extent.low.x, extent.high.y}, {extent.width() / columns, extent.height() / rows}, columns + 1, rows + 1};
}

Scene make_scene(const HeightField& field, const std::vector<double>& values, const Window& window,
                 const PerspectiveOptions& options, const Range& range, const Context& context) {
  const ReliefOptions& relief = options.relief;
  const double z = relief.exaggeration;
  const Vec2 middle = window.at((window.columns - 1) / 2.0, (window.rows - 1) / 2.0);
  const double half_x = window.step.x * (window.columns - 1) / 2, half_y = window.step.y * (window.rows - 1) / 2;
  const double half_z = z * (range.high - options.base) / 2;
  const double radius = std::max(std::sqrt(half_x * half_x + half_y * half_y + half_z * half_z), 1e-12);
  const Camera camera({middle.x, middle.y, z * options.base + half_z}, radius, options.from, options.elevation);
  const double scale = relief.high > relief.low ? 1 / (relief.high - relief.low) : 0;
  Scene scene{window.columns, window.rows, {}, {}, {}};
  scene.top.resize(field.heights.size());
  scene.foot.resize(field.heights.size());
  scene.colors.resize(field.heights.size());
  parallel_chunks(static_cast<std::size_t>(window.rows), 16, context, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      for (int column = 0; column < window.columns; ++column) {
        const std::size_t i = scene.index(column, row);
        if (std::isnan(field.heights[i]) || std::isnan(values[i])) continue;
        const Vec2 p = window.at(column, row);
        scene.top[i] = camera.project({p.x, p.y, z * field.heights[i]});
        scene.foot[i] = camera.project({p.x, p.y, z * options.base});
        scene.colors[i] = shade(field.gradients[i], relief) * ramp_color(relief.ramp, (values[i] - relief.low) * scale);
      }
  });
  return scene;
}

/// Moves and scales the scene so that all of it fits into width x height, with a small margin.
void fit_scene(Scene& scene, int width, int height) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double left = kInfinity, right = -kInfinity, top = kInfinity, bottom = -kInfinity;
  for (std::size_t i = 0; i < scene.top.size(); ++i) {
    if (!scene.data(i)) continue;
    for (const ScreenPoint& p : {scene.top[i], scene.foot[i]}) {
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
  }
  const double margin = 0.02 * std::min(width, height);
  const double scale = std::min((width - 2 * margin) / std::max(right - left, 1e-12),
                                (height - 2 * margin) / std::max(bottom - top, 1e-12));
  for (auto* points : {&scene.top, &scene.foot})
    for (ScreenPoint& p : *points) {
      p.x = width / 2.0 + scale * (p.x - (left + right) / 2);
      p.y = height / 2.0 + scale * (p.y - (top + bottom) / 2);
    }
}

/// Cells of a row, from column `first` on, that are drawn one after the other.
struct Run {
  int row, first;
};
constexpr int kRun = 64;

/// Puts the runs that touch each band, once.
void put_runs(const Scene& scene, BandLists<Run>& bands, const Context& context) {
  for (int row = 0; row + 1 < scene.rows; ++row) {
    context.check();
    for (int first = 0; first + 1 < scene.columns; first += kRun) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (int r = row; r <= row + 1; ++r)
        for (int column = first; column <= std::min(first + kRun, scene.columns - 1); ++column) {
          const std::size_t i = scene.index(column, r);
          if (!scene.data(i)) continue;
          low = std::min({low, scene.top[i].y, scene.foot[i].y});
          high = std::max({high, scene.top[i].y, scene.foot[i].y});
        }
      bands.put({row, first}, low - 1, high + 1);
    }
  }
}

void draw_run(const Scene& scene, const Run& run, Canvas& canvas) {
  const auto cell = [&](int column, int row) {
    return column >= 0 && row >= 0 && column + 1 < scene.columns && row + 1 < scene.rows &&
           scene.data(scene.index(column, row)) && scene.data(scene.index(column + 1, row)) &&
           scene.data(scene.index(column, row + 1)) && scene.data(scene.index(column + 1, row + 1));
  };
  const auto wall = [&](std::size_t a, std::size_t b) {
    const Color gray{kWallBrightness, kWallBrightness, kWallBrightness};
    canvas.quad({scene.top[a], scene.top[b], scene.foot[b], scene.foot[a]}, {gray, gray, gray, gray});
  };
  const int row = run.row;
  for (int column = run.first; column < std::min(run.first + kRun, scene.columns - 1); ++column) {
    if (!cell(column, row)) continue;
    const std::size_t nw = scene.index(column, row), ne = nw + 1, sw = scene.index(column, row + 1), se = sw + 1;
    canvas.quad({scene.top[nw], scene.top[ne], scene.top[se], scene.top[sw]},
                {scene.colors[nw], scene.colors[ne], scene.colors[se], scene.colors[sw]});
    if (!cell(column, row - 1)) wall(nw, ne);
    if (!cell(column, row + 1)) wall(sw, se);
    if (!cell(column - 1, row)) wall(nw, sw);
    if (!cell(column + 1, row)) wall(ne, se);
  }
}

Image draw_scene(const Scene& scene, int width, int height, const Context& context) {
  const int rows = kSamples * std::max(1, kBandSamples / (kSamples * kSamples * width));
  BandLists<Run> bands(height * kSamples, rows);
  put_runs(scene, bands, context);
  bands.turn();
  put_runs(scene, bands, context);
  Image image(width, height);
  context.report("drawing", 0);
  parallel_chunks(bands.count(), 1, context, [&](std::size_t band, std::size_t) {
    const auto [first, end] = bands.rows(band);
    Canvas canvas(width * kSamples, first, end);
    for (const Run& run : bands.of(band)) {
      context.check();
      draw_run(scene, run, canvas);
    }
    canvas.put(image);
  });
  context.report("drawing", 1);
  return image;
}

}  // namespace

Image draw_perspective(const FieldSource& surface, const Georef& georef, const Extent& extent, int width, int height,
                       const PerspectiveOptions& options, const FieldSource& color, const Context& context) {
  const Window window = sample_window(georef, extent, width, height);
  HeightField field = surface(window, context);
  HeightField other = color ? color(window, context) : HeightField{};
  Range range{0, 1};
  bool any = false;
  for (const double h : field.heights) {
    if (std::isnan(h)) continue;
    range = any ? Range{std::min(range.low, h), std::max(range.high, h)} : Range{h, h};
    any = true;
  }
  if (!any) return Image(width, height);
  Scene scene = make_scene(field, color ? other.heights : field.heights, window, options, range, context);
  field = other = {};
  fit_scene(scene, width * kSamples, height * kSamples);
  return draw_scene(scene, width, height, context);
}

}  // namespace retalho
