#include "tiled_terrain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "level_tree.h"
#include "retalho/core/error.h"

namespace retalho::viewer {
namespace {

constexpr double kMostHeld = 1.3e6;  // places
constexpr int kMostAcross = 64;      // squares of level 0
constexpr double kBehind = 1000;     // times coarser where no one looks
constexpr double kShare = 8;         // a square's side of so many allowed errors is small enough
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double length_of(int count, double cell) {
  return std::max(1, count - 1) * cell;
}

}  // namespace

TiledTerrain::TiledTerrain(const std::string& folder, std::size_t bound, const Context& context)
    : reader_(folder, bound), source_(tile_source(folder, bound)) {
  const TiledIndex& index = reader_.index();
  size_ = {length_of(index.columns, index.cell_width), -length_of(index.rows, index.cell_height)};
  const double shape = size_.x / -size_.y;
  across_ = std::clamp(static_cast<int>(std::lround(shape)), 1, kMostAcross);
  down_ = std::clamp(static_cast<int>(std::lround(1 / shape)), 1, kMostAcross);
  const auto places = [&](int level) {
    const double side = std::ldexp(1.0, level);
    return (across_ * side + 1) * (down_ * side + 1);
  };
  while (places(held_ + 1) <= kMostHeld) ++held_;
  look(context);
}

/// A hair inside of the box, whose outermost places rounding must not put outside.
Vec2 TiledTerrain::place(double x, double y) const {
  const double inset = 1e-7, width = across_ * std::ldexp(1.0, held_), height = down_ * std::ldexp(1.0, held_);
  return {size_.x * (inset + (1 - 2 * inset) * x / width), size_.y * (inset + (1 - 2 * inset) * y / height)};
}

void TiledTerrain::look(const Context& context) {
  columns_ = (static_cast<std::size_t>(across_) << held_) + 1;
  rows_ = (static_cast<std::size_t>(down_) << held_) + 1;
  heights_.resize(columns_ * rows_);
  gradients_.resize(columns_ * rows_);
  const Vec2 origin = place(0, 0), next = place(1, 1), step{next.x - origin.x, origin.y - next.y};
  // A row of tiles at a time: each is read once whatever the bound.
  const TiledIndex& index = reader_.index();
  const double a_row = index.tile_size * index.cell_height;
  for (std::size_t first = 0; first < rows_;) {
    context.check();
    const auto tile_row = std::floor((-origin.y + static_cast<double>(first) * step.y) / a_row);
    std::size_t some = 1;
    while (first + some < rows_ &&
           std::floor((-origin.y + static_cast<double>(first + some) * step.y) / a_row) == tile_row)
      ++some;
    const std::size_t at = first * columns_, count = some * columns_;
    sample_rows(reader_, {origin, step, static_cast<int>(columns_), static_cast<int>(first), static_cast<int>(some)},
                std::span(heights_).subspan(at, count), std::span(gradients_).subspan(at, count), context);
    first += some;
    context.report("look", static_cast<double>(first) / static_cast<double>(rows_));
  }
  low_ = std::numeric_limits<double>::infinity();
  high_ = -low_;
  for (const double z : heights_) {
    if (std::isnan(z)) continue;
    low_ = std::min(low_, z);
    high_ = std::max(high_, z);
  }
  if (!(low_ <= high_)) throw CannotRead("no tile of the tiled model holds any data where it was looked at");
}

TiledTerrain::Sample TiledTerrain::coarse(std::size_t x, std::size_t y) const {
  const std::size_t k = y * columns_ + x;
  return {heights_[k], std::isnan(heights_[k]) ? Vec2{} : gradients_[k]};
}

TriangleMesh TiledTerrain::detail(const DetailOptions& options, DetailNotes* notes, const Context& context) {
  const TiledIndex& index = reader_.index();
  const double side = std::max(size_.x / across_, -size_.y / down_);  // of a square of level 0
  const double cell = std::min(index.cell_width, index.cell_height);
  const int finest = std::clamp(static_cast<int>(std::ceil(std::log2(side / cell))), 0, LevelTree::kDeepest);
  const auto want = [&](const LevelSquare& s) {
    const double scale = std::ldexp(1.0, held_ - s.level), length = std::ldexp(side, -s.level);
    const double x = (s.i + 0.5) * scale, y = (s.j + 0.5) * scale;
    const double z = coarse(static_cast<std::size_t>(x), static_cast<std::size_t>(y)).height;
    const Vec2 p = place(x, y);
    const Vec3 way = Vec3{p.x, p.y, options.stretch * (std::isnan(z) ? 0.5 * (low_ + high_) : z)} - options.eye;
    // As near as the square's own size is as near as can be.
    const double distance = std::max(norm(way) - 0.75 * length, 0.25 * length);
    const bool behind = norm2(options.forward) > 0 && dot(way, options.forward) + norm(options.forward) * length < 0;
    return length / distance / (behind ? kBehind : 1);
  };
  LevelTree tree(across_, down_);
  tree.refine(want, kShare * options.angle, finest, options.budget / 5);
  context.check();
  const LevelTree::Fans fans = tree.fans();
  TriangleMesh mesh;
  mesh.positions.resize(fans.places.size());
  mesh.normals.resize(fans.places.size());
  const auto put = [&](std::size_t v, Vec2 p, double z, Vec2 gradient) {
    mesh.positions[v] = {p.x, p.y, z};
    mesh.normals[v] = normalized(Vec3{-gradient.x, -gradient.y, 1});
  };
  const double scale = std::ldexp(1.0, held_) / fans.halves;  // of a place, in what is held
  std::vector<std::size_t> asked;
  std::vector<Vec2> points;
  for (std::size_t v = 0; v < fans.places.size(); ++v) {
    const double x = fans.places[v][0] * scale, y = fans.places[v][1] * scale;
    const Vec2 p = place(x, y);
    if (x == std::floor(x) && y == std::floor(y)) {
      const Sample s = coarse(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
      put(v, p, s.height, s.gradient);
    } else {
      asked.push_back(v);
      points.push_back(p);
    }
  }
  const std::vector<std::optional<Jet>> jets = reader_.jets(points);
  context.check();
  for (std::size_t k = 0; k < asked.size(); ++k)
    put(asked[k], points[k], jets[k] ? jets[k]->value : kNan, jets[k] ? jets[k]->gradient : Vec2{});
  for (const auto& t : fans.triangles)
    if (std::none_of(t.begin(), t.end(), [&](std::uint32_t v) { return std::isnan(mesh.positions[v].z); }))
      mesh.triangles.push_back(t);
  for (Vec3& p : mesh.positions)
    if (std::isnan(p.z)) p.z = low_;  // of no triangle: the page takes numbers only
  if (notes) *notes = {options.angle, 1 << std::max(0, tree.deepest() - held_), tree.leaves()};
  return mesh;
}

SurfaceRange TiledTerrain::range(const Context& context) {
  const std::lock_guard lock(range_mutex_);
  if (!range_) range_ = measure_range(source_, context);
  return *range_;
}

ContourSet TiledTerrain::contours(std::vector<double> levels, const std::function<void(std::size_t points)>& check,
                                  const Context& context) {
  const double tolerance = 0.1 * std::min(index().cell_width, index().cell_height);
  ContourSet all;
  ContourSet set = stream_contours(
      source_, range(context), std::move(levels), {.tolerance = tolerance},
      [&](const ContourSet& part) {
        for (const ContourLine& line : part.lines) {
          const std::size_t begin = all.points.size();
          all.points.insert(all.points.end(), part.points.begin() + static_cast<std::ptrdiff_t>(line.begin),
                            part.points.begin() + static_cast<std::ptrdiff_t>(line.end));
          all.lines.push_back({line.level, line.closed, begin, all.points.size()});
        }
        check(all.points.size());
      },
      context);
  set.points = std::move(all.points);
  set.lines = std::move(all.lines);
  return set;
}

}  // namespace retalho::viewer
