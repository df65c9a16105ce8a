// The slow twin of the least-squares fit: dense normal equations of rows that are taken from TerrainEvaluator, one
// unknown (a height, or a coordinate of a gradient) at a time.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "retalho/raster/raster.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/terrain.h"

namespace retalho::test {

/// The sum that the fit minimises, with rows from the evaluator: no fairness (the twin has no second derivatives).
struct FitTwin {
  Eigen::MatrixXd rows;
  Eigen::VectorXd values;

  FitTwin(const Terrain& start, const Raster& raster, double slope_weight) {
    const bool flat = start.kind == SurfaceKind::linear;
    const std::size_t unknowns = start.tin.vertex_count() + 2 * start.gradients.size();
    const double unit = std::sqrt(raster.cell_width * raster.cell_height);
    std::vector<Vec2> places;
    for (int r = 0; r < raster.rows; ++r)
      for (int c = 0; c < raster.columns; ++c)
        if (raster.valid(c, r)) places.push_back(raster.centre(c, r));
    const auto n = static_cast<Eigen::Index>(places.size());
    rows = Eigen::MatrixXd::Zero(3 * n, static_cast<Eigen::Index>(unknowns));
    values = Eigen::VectorXd::Zero(3 * n);
    const double w = flat ? 0 : std::sqrt(slope_weight) * unit;
    const auto slope = [&](Vec2 p) -> std::optional<Vec2> {
      const int c = static_cast<int>(std::lround(p.x / raster.cell_width)),
                r = static_cast<int>(std::lround(-p.y / raster.cell_height));
      if (c == 0 || r == 0 || c == raster.columns - 1 || r == raster.rows - 1) return std::nullopt;
      const Vec2 d{(raster.at(c + 1, r) - raster.at(c - 1, r)) / (2 * raster.cell_width),
                   (raster.at(c, r - 1) - raster.at(c, r + 1)) / (2 * raster.cell_height)};
      return std::isnan(d.x) || std::isnan(d.y) ? std::nullopt : std::optional(d);
    };
    for (Eigen::Index k = 0; k < n; ++k) {
      const Vec2 p = places[static_cast<std::size_t>(k)];
      values[3 * k] = raster.at(static_cast<int>(std::lround(p.x / raster.cell_width)),
                                static_cast<int>(std::lround(-p.y / raster.cell_height)));
      if (const auto d = slope(p)) {
        values[3 * k + 1] = w * d->x;
        values[3 * k + 2] = w * d->y;
      }
    }
    for (std::size_t u = 0; u < unknowns; ++u) {
      Terrain one = start;
      std::fill(one.tin.heights.begin(), one.tin.heights.end(), 0);
      std::fill(one.gradients.begin(), one.gradients.end(), Vec2{});
      const std::size_t vertices = start.tin.vertex_count();
      if (u < vertices) {
        one.tin.heights[u] = 1;
      } else {
        Vec2& g = one.gradients[(u - vertices) / 2];
        ((u - vertices) % 2 == 0 ? g.x : g.y) = 1;
      }
      const TerrainEvaluator evaluator(one);
      for (Eigen::Index k = 0; k < n; ++k) {
        const auto jet = evaluator.jet(places[static_cast<std::size_t>(k)]);
        const auto column = static_cast<Eigen::Index>(u);
        rows(3 * k, column) = jet->value;
        if (slope(places[static_cast<std::size_t>(k)])) {
          rows(3 * k + 1, column) = w * jet->gradient.x;
          rows(3 * k + 2, column) = w * jet->gradient.y;
        }
      }
    }
  }
  double best() const { return (rows * rows.colPivHouseholderQr().solve(values) - values).squaredNorm(); }
  double cost(const Terrain& t) const {
    Eigen::VectorXd u(rows.cols());
    Eigen::Index at = 0;
    for (const double z : t.tin.heights) u[at++] = z;
    for (const Vec2 g : t.gradients) {
      u[at++] = g.x;
      u[at++] = g.y;
    }
    return (rows * u - values).squaredNorm();
  }
};

}  // namespace retalho::test
