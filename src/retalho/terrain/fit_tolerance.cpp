#include "retalho/terrain/fit_tolerance.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "retalho/core/parallel.h"
#include "retalho/terrain/fit_moves.h"
#include "retalho/terrain/report.h"

namespace retalho {
namespace {

constexpr double kFewViolate = 0.3;   // of the triangles: where growing for the sum of squares ends
constexpr double kWorst = 0.4;        // of the violating triangles are refined in a round
constexpr int kReweightings = 4;      // a round
constexpr int kPatience = 60;         // rounds until violating cells are held one by one
constexpr double kLateSlope = 0.015;  // the weights once the tolerance alone counts

/// The largest error of a triangle and its cell.
struct Worst {
  double error = 0;
  std::size_t cell = 0;
};

class Refinement {
 public:
  Refinement(FitState& state, const ToleranceOptions& options, const Context& context)
      : s_(state), options_(options), context_(context) {}

  void run(double goal) {
    goal_ = goal;
    if (!started_) {
      started_ = true;
      grow();
      better(s_, options_.relocations, options_.exchanges, context_);
      s_.weights.slope = std::min(s_.weights.slope, kLateSlope);
      s_.cell_weights.assign(s_.grid.z.size(), 1.0F);
      s_.refresh(context_, true);
      s_.solve(kRoughSolve, context_);
      reweight_and_insert();
    }
    hold_violating_cells();
    s_.solve(kFinalSolve, context_);
    report("tolerance", 1);
  }

  bool over_budget() const { return options_.vertices != 0 && s_.mesh.vertex_count() >= options_.vertices; }

 private:
  /// Fractions that depend on what is left fall back now and then: not so what is told.
  void report(const char* stage, double fraction) {
    if (stage != stage_) told_ = 0;
    stage_ = stage;
    told_ = std::max(told_, fraction);
    context_.report(stage, told_);
  }

  std::size_t room() const {
    return options_.vertices == 0 ? s_.grid.z.size()
                                  : options_.vertices - std::min(options_.vertices, s_.mesh.vertex_count());
  }

  std::vector<Worst> scan() const {
    std::vector<Worst> worst(s_.mesh.triangle_count());
    parallel_chunks(worst.size(), 64, context_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const auto t = static_cast<std::uint32_t>(k);
        Worst w;
        each_error(s_.kind, s_.triangle(t), s_.corner_data(t), s_.grid, s_.weights.inside,
                   [&](std::size_t cell, double error) {
                     if (std::abs(error) > w.error) w = {std::abs(error), cell};
                   });
        worst[k] = w;
      }
    });
    return worst;
  }

  /// Violating triangles, the worst first.
  std::vector<std::uint32_t> violating(const std::vector<Worst>& worst) const {
    std::vector<std::uint32_t> list;
    for (std::uint32_t t = 0; t < worst.size(); ++t)
      if (worst[t].error > goal_) list.push_back(t);
    std::stable_sort(list.begin(), list.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return worst[a].error > worst[b].error; });
    return list;
  }

  void grow() {
    while (room() > 0) {
      context_.check();
      const std::vector<std::uint32_t> list = violating(scan());
      const double share = static_cast<double>(list.size()) / static_cast<double>(s_.mesh.triangle_count());
      report("refine", std::min(1.0, kFewViolate / std::max(share, 1e-9)));
      if (share < kFewViolate) return;
      const auto round = std::max<std::size_t>(
          1, static_cast<std::size_t>(options_.growth * static_cast<double>(s_.mesh.vertex_count())));
      if (insert_in(s_, list, std::min(round, room()), context_) == 0) return;
      s_.refresh(context_);
      s_.solve(kRoughSolve, context_);
      s_.set_gradient_price();
      refold(s_, context_);
    }
  }

  void reweight_and_insert() {
    s_.gradient_price = 0;  // from here a fold that misses more is paid for in vertices
    for (int round = 0; round < kPatience; ++round) {
      for (int k = 0; k < kReweightings; ++k) {
        if (!reweigh(s_, goal_, context_)) return;
        s_.solve(kRoughSolve, context_);
      }
      const std::vector<std::uint32_t> list = violating(scan());
      report("tolerance", 1.0 / (1.0 + static_cast<double>(list.size())));
      if (list.empty() || room() == 0) return;
      const auto count = static_cast<std::size_t>(std::ceil(kWorst * static_cast<double>(list.size())));
      if (insert_in(s_, list, std::min(count, room()), context_) == 0) return;
      s_.refresh(context_);
      s_.solve(kRoughSolve, context_);
      refold(s_, context_);
    }
  }

  /// The end of every refinement: each violating cell becomes a vertex, and each violating vertex keeps its cell's
  /// height. A round holds at least one more cell; held cells have no error.
  void hold_violating_cells() {
    while (true) {
      context_.check();
      const std::vector<Worst> worst = scan();
      const std::vector<std::uint32_t> list = violating(worst);
      if (list.empty()) return;
      const auto across = static_cast<std::size_t>(s_.grid.columns);
      bool held = false;
      for (const std::uint32_t t : list) {
        if (s_.mesh.is_changed(t)) continue;
        const std::size_t k = worst[t].cell;
        const greedy::Cell cell = greedy::cell_at(static_cast<int>(k % across), static_cast<int>(k / across));
        const auto& corners = s_.mesh.triangles()[t];
        std::uint32_t vertex = kNone;
        for (const std::uint32_t v : corners)
          if (s_.mesh.cell(v) == cell) vertex = v;
        if (vertex == kNone) {
          if (room() == 0 || !s_.insert(cell, t, s_.surface_at(t, cell))) continue;
          vertex = static_cast<std::uint32_t>(s_.mesh.vertex_count() - 1);
        }
        if (s_.pinned[vertex] != 0) continue;
        s_.pinned[vertex] = 1;
        s_.data[vertex].x = s_.grid.z[k];
        held = true;
      }
      if (!held) return;  // a budget is spent
      s_.refresh(context_);
      s_.solve({1e-6, 200}, context_);
    }
  }

  FitState& s_;
  const ToleranceOptions& options_;
  const Context& context_;
  double goal_ = 0;
  bool started_ = false;
  std::string_view stage_;
  double told_ = 0;
};

}  // namespace

bool reweigh(FitState& s, double tolerance, const Context& context) {
  std::vector<std::uint8_t> touched(s.mesh.triangle_count(), 0), over(touched);
  parallel_chunks(touched.size(), 64, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto t = static_cast<std::uint32_t>(k);
      each_error(s.kind, s.triangle(t), s.corner_data(t), s.grid, s.weights.inside,
                 [&](std::size_t cell, double error) {
                   const double q = std::abs(error) / tolerance, w = s.cell_weights[cell];
                   double next = std::max(1.0, 0.8 * w);
                   if (q > 0.8) {
                     const double near = 1 + 20 * ((q - 0.8) / 0.2) * ((q - 0.8) / 0.2);
                     next = (std::max(w, 1.0) + std::max(w * (q > 1 ? 1.6 : 1), std::min(200.0, near))) / 2;
                   }
                   next = std::min(next, 1e4);
                   if (q > 1) over[k] = 1;
                   if (std::abs(next - w) <= 0.01 * w) return;
                   s.cell_weights[cell] = static_cast<float>(next);
                   touched[k] = 1;
                 });
    }
  });
  if (std::find(over.begin(), over.end(), 1) == over.end()) return false;
  s.weights.cells = s.cell_weights;
  parallel_chunks(touched.size(), 32, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (touched[k] != 0)
        s.elements[k] = fit_element(s.kind, s.triangle(static_cast<std::uint32_t>(k)), s.grid, s.weights);
  });
  return true;
}

Terrain refine_to_tolerance(FitState& state, const Raster& raster, const ToleranceOptions& options,
                            const Context& context) {
  Refinement refinement(state, options, context);
  // The surface that is handed out is judged by the report's own scan; should that see an error that rounding hid here,
  // the goal is tightened, in the end to nothing.
  for (double margin = 1e-9;; margin *= 100) {
    refinement.run(std::max(0.0, options.max_error * (1 - margin)));
    Terrain terrain = to_terrain(state, raster, context);
    if (margin > 1 || refinement.over_budget() || assess(terrain, raster, options.max_error, context).violations == 0)
      return terrain;
  }
}

}  // namespace retalho
