#include "retalho/model/baselines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "retalho/model/compact.h"
#include "retalho/model/model.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/report.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/tin/refine.h"

namespace retalho {
namespace {

constexpr std::size_t kLeast = 4;  // vertices
constexpr std::size_t kFlatNumbers = 3, kSmoothNumbers = 5;

/// A surface as it is written.
struct Written {
  Terrain terrain;
  std::size_t bytes = 0;
};
/// A surface of so many vertices.
using Make = std::function<Written(std::size_t vertices)>;

Written exact(Terrain terrain) {
  const std::size_t bytes = encode_model(terrain).size();
  return {std::move(terrain), bytes};
}
Written compact(CompactModel model) {
  return {std::move(model.terrain), model.bytes.size()};
}

/// The largest number of vertices that is found whose bytes are the wanted ones or hardly more: bytes are nearly a
/// power of the vertices.
Written with_bytes(const Make& make, std::size_t wanted, std::size_t first, std::size_t most, const Context& context) {
  constexpr double kClose = 0.005;
  constexpr int kTries = 6;
  Written best;
  double off = INFINITY;
  double n = static_cast<double>(first);
  for (int k = 0; k < kTries && off > kClose; ++k) {
    context.check();
    const auto vertices = std::clamp(static_cast<std::size_t>(std::llround(n)), kLeast, most);
    Written made = make(vertices);
    const double ratio = static_cast<double>(made.bytes) / static_cast<double>(wanted);
    if (std::abs(std::log(ratio)) < off) {
      off = std::abs(std::log(ratio));
      best = std::move(made);
    }
    const double next = static_cast<double>(vertices) / ratio;
    if (std::llround(next) == static_cast<long long>(vertices)) break;
    n = next;
  }
  return best;
}

ModelReport report_of(const Written& written, const std::string& name, const Raster& raster, const Context& context) {
  ModelReport report = facts_of(written.terrain);
  report.name = name;
  report.bytes = written.bytes;
  report.errors = assess(written.terrain, raster, 0, context);
  return report;
}

}  // namespace

std::vector<ModelReport> flat_baselines(const Rival& rival, const Raster& raster, const Context& context) {
  const auto greedy_terrain = [&](std::size_t n) {
    return make_terrain(refine_tin(raster, {.vertices = n}, context), raster, {.surface = SurfaceKind::linear},
                        context);
  };
  const Make greedy = [&](std::size_t n) {
    Terrain terrain = greedy_terrain(n);
    if (!rival.compact) return exact(std::move(terrain));
    return compact(compact_terrain(terrain, raster, {.surface = SurfaceKind::linear, .vertices = n}, context));
  };
  const Make strong = [&](std::size_t n) {
    if (rival.compact) return compact(fit_compact(raster, {.surface = SurfaceKind::linear, .vertices = n}, context));
    return exact(refine_surface(raster, {.surface = SurfaceKind::linear, .vertices = n}, context));
  };
  const std::size_t most = summarize(raster).valid;
  const std::size_t equal = std::clamp(rival.numbers / kFlatNumbers, kLeast, std::max(kLeast, most));
  std::vector<ModelReport> reports;
  for (const auto& [word, make] : {std::pair{"greedy", &greedy}, std::pair{"strong", &strong}}) {
    const Written same = (*make)(equal);
    reports.push_back(report_of(same, fmt::format("{} linear, numbers of {}", word, rival.name), raster, context));
    const double ratio = static_cast<double>(rival.bytes) / static_cast<double>(same.bytes);
    const auto guess = static_cast<std::size_t>(std::llround(static_cast<double>(equal) * ratio));
    reports.push_back(
        report_of(with_bytes(*make, rival.bytes, std::max(kLeast, guess), std::max(kLeast, most), context),
                  fmt::format("{} linear, bytes of {}", word, rival.name), raster, context));
  }
  return reports;
}

std::vector<ModelReport> smooth_rivals(std::size_t vertices, const Raster& raster, const Context& context) {
  const Make smooth = [&](std::size_t n) { return exact(refine_surface(raster, {.vertices = n}, context)); };
  const Make small = [&](std::size_t n) { return compact(fit_compact(raster, {.vertices = n}, context)); };
  const std::size_t most = std::max(kLeast, summarize(raster).valid);
  const std::size_t equal = std::clamp(vertices * kFlatNumbers / kSmoothNumbers, kLeast, most);
  std::vector<ModelReport> reports;
  const auto add = [&](const Written& written, const std::string& name) {
    reports.push_back(report_of(written, name, raster, context));
  };
  const Written flat = exact(refine_surface(raster, {.surface = SurfaceKind::linear, .vertices = vertices}, context));
  add(flat, "strong linear");
  add(smooth(equal), "clough-tocher refined, its numbers");
  add(with_bytes(smooth, flat.bytes, equal, most, context), "clough-tocher refined, its bytes");
  const Written flat_small =
      compact(fit_compact(raster, {.surface = SurfaceKind::linear, .vertices = vertices}, context));
  add(flat_small, "strong linear, compact");
  add(with_bytes(small, flat_small.bytes, std::max(kLeast, vertices / 2), most, context),
      "clough-tocher compact, its bytes");
  return reports;
}

}  // namespace retalho
