#include "retalho/model/compact_tolerance.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <map>

#include "retalho/model/fit_source.h"

namespace retalho {
namespace {

using greedy::Cell;

double env(const char* n, double d) { const char* t = std::getenv(n); return t ? std::atof(t) : d; }

constexpr double kTight = 1e-6, kLoose = 1e-3;  // of the fit's residual

class Loop {
 public:
  Loop(double tolerance, std::vector<Cell> cells, const Raster& raster, const CompactFrameFacts& facts,
       const HeldFitOptions& options, const Context& context)
      : tolerance_(tolerance),
        raster_(raster),
        facts_(facts),
        options_(options),
        context_(context),
        gradients_(options.surface == SurfaceKind::clough_tocher && !options.heights_only),
        cells_(std::move(cells)),
        fit_(raster, cells_, options, context) {}

  CompactEncoding run() {
    const double goal = env("GOAL", 0.95) * tolerance_;
    fit_.solve(kTight);
    for (int k = 0; k < env("LAWSON", 12) && fit_.reweigh(goal); ++k) fit_.solve(kLoose, 60);
    weights_ = fit_.cell_weights();
    FitSource source(fit_);
    CompactEncoding encoding = encode_compact(facts_, cells_, source, context_);
    measure_steps();
    bool changed = false;
    for (int round = 0;; ++round) {
      std::vector<std::uint32_t> over = fit_.vertices_over(tolerance_);
      if (std::getenv("V")) fmt::print(stderr, "round {} V={} bytes={} over={}", round, cells_.size(), encoding.bytes.size(), over.size());
      if (over.empty()) break;
      changed = true;
      descend(over);
      over = fit_.vertices_over(tolerance_);
      if (std::getenv("V")) fmt::print(stderr, " after {}\n", over.size());
      if (over.empty()) break;
      add_vertices(round >= 6);
    }
    if (!changed) return encoding;
    SettledSource settled(fit_);
    return encode_compact(facts_, cells_, settled, context_);
  }

 private:
  std::uint32_t number(Cell c) const {
    return static_cast<std::uint32_t>(std::lower_bound(cells_.begin(), cells_.end(), c) - cells_.begin());
  }
  double cell_height(Cell c) const { return raster_.at(greedy::column_of(c), greedy::row_of(c)); }
  double on_lattice(double height, double step) const {
    return facts_.reference + LatticeSteps::nearest(height - facts_.reference, step);
  }
  void measure_steps() { steps_ = lattice_steps(triangulate_cells(cells_), facts_.steps); }

  /// Sweeps over these vertices: each takes the neighbouring place on its lattices where the excess around it is least.
  void descend(const std::vector<std::uint32_t>& list) {
    for (int sweep = 0; sweep < 12; ++sweep) {
      bool moved = false;
      for (const std::uint32_t v : list) moved |= improve(v);
      if (!moved) return;
    }
  }

  bool improve(std::uint32_t v) {
    double height = fit_.height(v);
    Vec2 gradient = fit_.gradient(v);
    double best = fit_.excess(v, height, gradient, tolerance_);
    if (best == 0) return false;
    bool moved = false;
    const double h = steps_.height[v], g = steps_.slope[v];
    const bool pinned = std::binary_search(pinned_.begin(), pinned_.end(), cells_[v]);
    while (best > 0) {
      double least = best * (1 - 1e-9), to_height = height;
      Vec2 to_gradient = gradient;
      const auto attempt = [&](double z, Vec2 slope) {
        const double cost = fit_.excess(v, z, slope, tolerance_);
        if (cost >= least) return;
        least = cost;
        to_height = z;
        to_gradient = slope;
      };
      for (const int k : {-1, 1, -2, 2}) {
        if (!pinned) attempt(on_lattice(height + k * h, h), gradient);
        if (!gradients_) continue;
        attempt(height, {LatticeSteps::nearest(gradient.x + k * g, g), gradient.y});
        attempt(height, {gradient.x, LatticeSteps::nearest(gradient.y + k * g, g)});
      }
      if (!(least < best * (1 - 1e-9))) break;
      best = least;
      height = to_height;
      gradient = to_gradient;
      fit_.set(v, height, gradient);
      moved = true;
    }
    return moved;
  }

  void add_vertices(bool pin) {
    const std::vector<double> errors = fit_.errors();
    std::vector<Cell> added = fit_.worst_cells(tolerance_);
    for (const std::uint32_t v : fit_.vertices_over(tolerance_)) {
      const Cell c = cells_[v];
      const std::size_t at = raster_.index(greedy::column_of(c), greedy::row_of(c));
      if (pin && std::abs(errors[at]) > tolerance_) pinned_.push_back(c);
    }
    std::map<Cell, VertexJet> values;
    for (std::uint32_t v = 0; v < cells_.size(); ++v)
      values[cells_[v]] = {fit_.height(v), fit_.gradient(v).x, fit_.gradient(v).y};
    for (const Cell c : added) {
      values[c] = {cell_height(c) + errors[raster_.index(greedy::column_of(c), greedy::row_of(c))], 0, 0};
      if (pin) pinned_.push_back(c);
    }
    std::sort(pinned_.begin(), pinned_.end());
    pinned_.erase(std::unique(pinned_.begin(), pinned_.end()), pinned_.end());
    if (weights_.empty()) weights_.assign(raster_.cells(), 1.0F);
    for (std::size_t k = 0; k < errors.size(); ++k)
      if (std::abs(errors[k]) > tolerance_) weights_[k] = std::min(1e4F, std::max(weights_[k], 20.0F) * 2);
    cells_.clear();
    for (const auto& [cell, value] : values) cells_.push_back(cell);
    fit_ = HeldFit(raster_, cells_, options_, context_);
    fit_.set_cell_weights(weights_);
    measure_steps();
    for (std::uint32_t v = 0; v < cells_.size(); ++v) {
      const VertexJet& u = values.at(cells_[v]);
      hold(v, u[0], {u[1], u[2]});
    }
    // The new ones and their neighbours' gradients find their places; then they are rounded, one after the other.
    std::vector<std::uint32_t> free;
    for (const Cell c : added) {
      const std::uint32_t v = number(c);
      free.push_back(v);
      for (const std::uint32_t w : fit_.neighbors(v)) free.push_back(w);
    }
    std::sort(free.begin(), free.end());
    free.erase(std::unique(free.begin(), free.end()), free.end());
    for (const std::uint32_t v : free) fit_.release(v);
    for (const Cell c : pinned_) fit_.hold_height(number(c), on_lattice(cell_height(c), steps_.height[number(c)]));
    fit_.solve(kTight, 200);
    for (const std::uint32_t v : free) hold(v, fit_.height(v), fit_.gradient(v));
  }

  void hold(std::uint32_t v, double height, Vec2 gradient) {
    fit_.hold_height(v, on_lattice(height, steps_.height[v]));
    if (!gradients_) return;
    fit_.hold_gradient(v, {LatticeSteps::nearest(gradient.x, steps_.slope[v]),
                           LatticeSteps::nearest(gradient.y, steps_.slope[v])});
  }

  double tolerance_;
  const Raster& raster_;
  const CompactFrameFacts& facts_;
  const HeldFitOptions& options_;
  const Context& context_;
  bool gradients_;
  std::vector<Cell> cells_, pinned_;
  HeldFit fit_;
  LatticeSteps steps_;
  std::vector<float> weights_;
};

}  // namespace

CompactEncoding encode_within(double tolerance, std::vector<Cell> cells, const Raster& raster,
                              const CompactFrameFacts& facts, const HeldFitOptions& options, const Context& context) {
  return Loop(tolerance, std::move(cells), raster, facts, options, context).run();
}

}  // namespace retalho
