#include "retalho/model/compact_tolerance.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "retalho/model/fit_source.h"

namespace retalho {
namespace {

using greedy::Cell;

constexpr double kTight = 1e-6, kLoose = 1e-5;  // of the fit's residual
constexpr double kGoal = 0.95;                  // of the tolerance: what is left for the rounding
constexpr int kReweightings = 12;
constexpr int kSweeps = 12;
constexpr int kPatience = 6;  // rounds until vertices keep their cells' heights
// A number shorter by a bit or two may cost as many squared errors as five such bits' share of all: measured, it makes
// files 2 to 3 % smaller at the same RMSE and with truer slopes.
constexpr double kThrift = 8;

class Loop {
 public:
  Loop(double tolerance, FoldedVertices vertices, const Raster& raster, const CompactFrameFacts& facts,
       const HeldFitOptions& options, const Context& context)
      : tolerance_(tolerance),
        raster_(raster),
        facts_(facts),
        options_(options),
        context_(context),
        gradients_(options.surface == SurfaceKind::clough_tocher && !options.heights_only),
        cells_(std::move(vertices.cells)),
        folded_(std::move(vertices.folded)),
        fit_(raster, cells_, options, context, folded_) {}

  CompactEncoding run() {
    fit_.solve(kTight);
    for (int k = 0; k < kReweightings && fit_.reweigh(kGoal * tolerance_); ++k) fit_.solve(kLoose, 60);
    weights_ = fit_.cell_weights();
    FitSource source(fit_);
    // Its size sets a rate below: without the CRS, whose text is no part of what is weighed there.
    CompactFrameFacts bare = facts_;
    bare.georef.crs_wkt.clear();
    const CompactEncoding first = encode_compact(bare, cells_, source, context_, folded_);
    measure_steps();
    for (int round = 0;; ++round) {
      context_.check();
      const std::vector<std::uint32_t> over = fit_.vertices_over(tolerance_);
      context_.report("round", 1.0 / (1.0 + static_cast<double>(over.size())));
      if (over.empty()) break;
      descend(over);
      if (fit_.vertices_over(tolerance_).empty()) break;
      add_vertices(round >= kPatience);
    }
    double squares = 0;
    for (const double e : fit_.errors())
      if (!std::isnan(e)) squares += (e / tolerance_) * (e / tolerance_);
    const double a_bit = squares / (8.0 * static_cast<double>(first.bytes.size()));
    fold_where_it_does_no_harm(a_bit);
    ThriftySource thrifty(fit_, tolerance_, kThrift * a_bit);
    return encode_compact(facts_, cells_, thrifty, context_, folded_);
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

  /// Sweeps over these vertices: each takes the neighbouring places on its lattices where the excess around it is
  /// least.
  void descend(const std::vector<std::uint32_t>& list) {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      bool moved = false;
      for (const std::uint32_t v : list) moved |= improve(v);
      if (!moved) return;
    }
  }

  /// Vertices that may do without a gradient: no cell passes the tolerance, and the squared errors grow by no more than
  /// the gradient's bits are worth.
  void fold_where_it_does_no_harm(double a_bit) {
    if (folded_.empty()) return;
    constexpr double kGradientBits = 20;  // in the terms of kThrift; it has about nine
    for (std::uint32_t v = 0; v < cells_.size(); ++v) {
      if (v % 64 == 0) context_.check();
      if (folded_[v] != 0) continue;
      const double height = fit_.height(v), step = steps_.height[v];
      double least = fit_.star_errors(v, height, fit_.gradient(v), tolerance_).squares + kGradientBits * a_bit;
      double to = NAN;
      const int far = std::binary_search(pinned_.begin(), pinned_.end(), cells_[v]) ? 0 : 1;
      for (int k = -far; k <= far; ++k) {
        const double z = k == 0 ? height : on_lattice(height + k * step, step);
        const HeldFit::StarErrors then = fit_.star_errors_folded(v, z, tolerance_);
        if (then.excess > 0 || then.squares >= least) continue;
        least = then.squares;
        to = z;
      }
      if (std::isnan(to)) continue;
      fit_.fold(v, to);
      folded_[v] = 1;
    }
  }

  bool improve(std::uint32_t v) {
    double height = fit_.height(v);
    Vec2 gradient = fit_.gradient(v);
    double best = fit_.star_errors(v, height, gradient, tolerance_).excess;
    if (best == 0) return false;
    bool moved = false;
    const double h = steps_.height[v], g = steps_.slope[v];
    const bool pinned = std::binary_search(pinned_.begin(), pinned_.end(), cells_[v]);
    while (best > 0) {
      double least = best * (1 - 1e-9), to_height = height;
      Vec2 to_gradient = gradient;
      const auto attempt = [&](double z, Vec2 slope) {
        const double cost = fit_.star_errors(v, z, slope, tolerance_).excess;
        if (cost >= least) return;
        least = cost;
        to_height = z;
        to_gradient = slope;
      };
      const int far = pinned ? 0 : 1, wide = gradients_ && !fit_.is_folded(v) ? 1 : 0;
      for (int a = -far; a <= far; ++a)
        for (int b = -wide; b <= wide; ++b)
          for (int c = -wide; c <= wide; ++c)
            if (a != 0 || b != 0 || c != 0)
              attempt(a == 0 ? height : on_lattice(height + a * h, h),
                      {b == 0 ? gradient.x : LatticeSteps::nearest(gradient.x + b * g, g),
                       c == 0 ? gradient.y : LatticeSteps::nearest(gradient.y + c * g, g)});
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
    std::map<Cell, std::uint8_t> folds;
    for (std::uint32_t v = 0; v < cells_.size(); ++v) {
      values[cells_[v]] = {fit_.height(v), fit_.gradient(v).x, fit_.gradient(v).y};
      if (!folded_.empty()) folds[cells_[v]] = folded_[v];
    }
    for (const Cell c : added) {
      values[c] = {cell_height(c) + errors[raster_.index(greedy::column_of(c), greedy::row_of(c))], 0, 0};
      if (pin) pinned_.push_back(c);
    }
    std::sort(pinned_.begin(), pinned_.end());
    pinned_.erase(std::unique(pinned_.begin(), pinned_.end()), pinned_.end());
    if (weights_.empty()) weights_.assign(raster_.cells(), 1.0F);
    for (std::size_t k = 0; k < errors.size(); ++k)
      if (std::abs(errors[k]) > tolerance_) weights_[k] = std::min(1e4F, std::max(weights_[k], 20.0F) * 2);
    const bool folding = !folded_.empty();
    cells_.clear();
    folded_.clear();
    for (const auto& [cell, value] : values) {
      cells_.push_back(cell);
      if (folding) folded_.push_back(folds[cell]);
    }
    fit_ = HeldFit(raster_, cells_, options_, context_, folded_);
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
    if (!gradients_ || fit_.is_folded(v)) return;
    fit_.hold_gradient(
        v, {LatticeSteps::nearest(gradient.x, steps_.slope[v]), LatticeSteps::nearest(gradient.y, steps_.slope[v])});
  }

  double tolerance_;
  const Raster& raster_;
  const CompactFrameFacts& facts_;
  const HeldFitOptions& options_;
  const Context& context_;
  bool gradients_;
  std::vector<Cell> cells_, pinned_;
  std::vector<std::uint8_t> folded_;  // empty: none
  HeldFit fit_;
  LatticeSteps steps_;
  std::vector<float> weights_;
};

}  // namespace

CompactEncoding encode_within(double tolerance, FoldedVertices vertices, const Raster& raster,
                              const CompactFrameFacts& facts, const HeldFitOptions& options, const Context& context) {
  return Loop(tolerance, std::move(vertices), raster, facts, options, context).run();
}

}  // namespace retalho
