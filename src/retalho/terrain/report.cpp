#include "retalho/terrain/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"

namespace retalho {
namespace {

constexpr int kBand = 64;           // rows that are assessed together; fixes the order of the sums
constexpr double kOutside = -1e-9;  // barycentric slack of cells on edges that are not the lattice's
using Lattice = std::array<std::int64_t, 2>;

/// The raster's cells in the model's local coordinates.
struct Cells {
  const Raster& raster;
  std::vector<double> x, y;
  double step_x = 1, step_y = 1;
  bool own_grid = false;  ///< the raster lies exactly as the model's own

  Cells(const Raster& r, const Georef& model)
      : raster(r), x(static_cast<std::size_t>(r.columns)), y(static_cast<std::size_t>(r.rows)) {
    const Georef& g = r.georef;
    own_grid = g.origin_x == model.origin_x && g.origin_y == model.origin_y && g.scale_x == model.scale_x &&
               g.scale_y == model.scale_y;
    const auto place = [&](double column, double row) {
      const Vec2 p = r.centre(column, row);
      return own_grid ? p : model.to_local(g.to_crs(p));
    };
    for (int c = 0; c < r.columns; ++c) x[static_cast<std::size_t>(c)] = place(c, 0).x;
    for (int k = 0; k < r.rows; ++k) y[static_cast<std::size_t>(k)] = place(0, k).y;
    step_x = place(1, 0).x - place(0, 0).x;
    step_y = place(0, 0).y - place(0, 1).y;
  }
  double column_of(double at) const { return (at - x[0]) / step_x; }
  double row_of(double at) const { return (y[0] - at) / step_y; }
};

/// Cell coordinates of the vertices, when every vertex is a cell of the raster; else empty.
std::vector<Lattice> lattice_vertices(const Tin& tin, const Cells& cells) {
  std::vector<Lattice> result;
  if (!cells.own_grid) return result;
  result.reserve(tin.vertex_count());
  for (const Vec2 p : tin.points) {
    const double c = std::floor(cells.column_of(p.x) + 0.5), r = std::floor(cells.row_of(p.y) + 0.5);
    if (!(c >= 0 && r >= 0 && c < cells.raster.columns && r < cells.raster.rows)) return {};
    if (cells.x[static_cast<std::size_t>(c)] != p.x || cells.y[static_cast<std::size_t>(r)] != p.y) return {};
    result.push_back({static_cast<std::int64_t>(c), -static_cast<std::int64_t>(r)});
  }
  return result;
}

struct Bands {
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> triangles;
};

Bands bands_of(const Tin& tin, const Cells& cells) {
  Bands bands;
  const int rows = cells.raster.rows;
  bands.begin.assign(static_cast<std::size_t>((rows + kBand - 1) / kBand) + 1, 0);
  const auto each = [&](const auto& use) {
    for (std::uint32_t t = 0; t < tin.triangles.size(); ++t) {
      const auto& v = tin.triangles[t];
      const auto [low, high] = std::minmax({tin.points[v[0]].y, tin.points[v[1]].y, tin.points[v[2]].y});
      const double first = std::max(0.0, std::floor(cells.row_of(high))),
                   last = std::min(rows - 1.0, std::ceil(cells.row_of(low)));
      if (!(first <= last)) continue;
      for (int b = static_cast<int>(first) / kBand; b <= static_cast<int>(last) / kBand; ++b)
        use(static_cast<std::size_t>(b), t);
    }
  };
  each([&](std::size_t b, std::uint32_t) { ++bands.begin[b + 1]; });
  for (std::size_t b = 1; b < bands.begin.size(); ++b) bands.begin[b] += bands.begin[b - 1];
  bands.triangles.resize(bands.begin.back());
  std::vector<std::size_t> next(bands.begin.begin(), bands.begin.end() - 1);
  each([&](std::size_t b, std::uint32_t t) { bands.triangles[next[b]++] = t; });
  return bands;
}

/// Sums of one band of rows.
struct Tally {
  std::size_t covered = 0, violations = 0, slopes = 0;
  double squares = 0, slope_squares = 0, largest = -1;
  std::size_t largest_cell = 0;

  void add(std::size_t cell, double error) {
    ++covered;
    squares += error * error;
    if (error > largest || (error == largest && cell < largest_cell)) {
      largest = error;
      largest_cell = cell;
    }
  }
  void add(const Tally& o) {
    covered += o.covered;
    violations += o.violations;
    slopes += o.slopes;
    squares += o.squares;
    slope_squares += o.slope_squares;
    if (o.largest > largest) {  // bands come in raster order: the first keeps a tie
      largest = o.largest;
      largest_cell = o.largest_cell;
    }
  }
};

/// The pieces of one triangle, ready to be asked.
struct Pieces {
  std::array<TerrainPatch, 6> patches;
  std::array<TriangleFrame, 6> frames;
  int count = 0;

  void load(const Terrain& terrain, const EdgeTable& edges, std::uint32_t t) {
    count = triangle_patches(terrain, edges, t, patches);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
      frames[k] = TriangleFrame(patches[k].corners[0], patches[k].corners[1], patches[k].corners[2]);
  }

  /// From the piece that holds `p`: the one where its smallest coordinate is largest.
  Jet jet(Vec2 p) const {
    std::size_t best = 0;
    Barycentric best_at = frames[0].barycentric(p);
    double most = std::min({best_at.r, best_at.s, best_at.t});
    for (std::size_t k = 1; k < static_cast<std::size_t>(count); ++k) {
      const Barycentric u = frames[k].barycentric(p);
      const double least = std::min({u.r, u.s, u.t});
      if (!(least > most)) continue;
      best = k;
      best_at = u;
      most = least;
    }
    return evaluate_piece(best, best_at);
  }

 private:
  Jet evaluate_piece(std::size_t k, Barycentric u) const {
    const auto with = [&]<int Degree>() {
      TriangleNet<Degree> net;
      std::copy_n(patches[k].ordinates.begin(), net.size(), net.begin());
      return evaluate_jet<Degree>(net, frames[k], u);
    };
    switch (patches[k].degree) {
      case 2:
        return with.template operator()<2>();
      case 3:
        return with.template operator()<3>();
      default:
        return with.template operator()<1>();
    }
  }
};

/// Twice the signed area of (a, b, p), in cells.
std::int64_t edge_function(const Lattice& a, const Lattice& b, const Lattice& p) {
  return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

class Assessment {
 public:
  Assessment(const Terrain& terrain, const Raster& raster, double tolerance, const AssessedPart* part = nullptr)
      : part_(part),
        terrain_(terrain),
        raster_(raster),
        cells_(raster, terrain.georef),
        edges_(build_edges(terrain.tin)),
        lattice_(lattice_vertices(terrain.tin, cells_)),
        bands_(bands_of(terrain.tin, cells_)),
        tolerance_(tolerance),
        summary_(summarize(raster)) {
    allowance_ = summary_.valid ? kRoundingAllowance * (summary_.maximum - summary_.minimum) : 0;
  }

  Tally tally(const Context& context) const {
    const std::size_t bands = bands_.begin.size() - 1;
    std::vector<Tally> tallies(bands);
    parallel_chunks(bands, 1, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) tallies[b] = band(b);
    });
    Tally all;
    for (const Tally& t : tallies) all.add(t);
    return all;
  }

  ErrorReport run(const Context& context) const {
    const Tally all = tally(context);
    if (all.covered == 0) throw BadInput("no valid cell of the grid lies on the model: do they cover the same ground?");
    ErrorReport report;
    report.cells = raster_.cells();
    report.valid_cells = summary_.valid;
    report.uncovered = summary_.valid - all.covered;
    report.violations = all.violations;
    report.rmse = std::sqrt(all.squares / static_cast<double>(all.covered));
    report.max_error = all.largest;
    const auto columns = static_cast<std::size_t>(raster_.columns);
    const auto column = all.largest_cell % columns, row = all.largest_cell / columns;
    report.max_error_at = raster_.georef.to_crs(raster_.centre(static_cast<double>(column), static_cast<double>(row)));
    report.slope_rmse = all.slopes ? std::sqrt(all.slope_squares / static_cast<double>(all.slopes)) : 0;
    return report;
  }

 private:
  Tally band(std::size_t b) const {
    const int first = static_cast<int>(b) * kBand, last = std::min(raster_.rows, first + kBand) - 1;
    std::vector<bool> seen(static_cast<std::size_t>(last - first + 1) * static_cast<std::size_t>(raster_.columns),
                           false);
    Tally tally;
    Pieces pieces;
    for (std::size_t k = bands_.begin[b]; k < bands_.begin[b + 1]; ++k) {
      const std::uint32_t t = bands_.triangles[k];
      pieces.load(terrain_, edges_, t);
      triangle(t, pieces, first, last, seen, tally);
    }
    return tally;
  }

  void triangle(std::uint32_t t, const Pieces& pieces, int first, int last, std::vector<bool>& seen,
                Tally& tally) const {
    const auto& v = terrain_.tin.triangles[t];
    std::array<double, 3> column, row;
    for (std::size_t k = 0; k < 3; ++k) {
      column[k] = cells_.column_of(terrain_.tin.points[v[k]].x);
      row[k] = cells_.row_of(terrain_.tin.points[v[k]].y);
    }
    first = std::max(first, static_cast<int>(std::max(0.0, std::floor(std::min({row[0], row[1], row[2]})))));
    last =
        std::min(last, static_cast<int>(std::min(raster_.rows - 1.0, std::ceil(std::max({row[0], row[1], row[2]})))));
    const TriangleFrame whole(terrain_.tin.points[v[0]], terrain_.tin.points[v[1]], terrain_.tin.points[v[2]]);
    for (int r = first; r <= last; ++r) {
      // The part of the row that can touch the triangle, with room to spare; each cell is then tested on its own.
      double left = std::numeric_limits<double>::infinity(), right = -left;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t m = (k + 1) % 3;
        const double top = std::min(row[k], row[m]) - 1e-6, bottom = std::max(row[k], row[m]) + 1e-6;
        if (r < top || r > bottom) continue;
        const double share = row[m] == row[k] ? 0.0 : std::clamp((r - row[k]) / (row[m] - row[k]), 0.0, 1.0);
        const double at = column[k] + share * (column[m] - column[k]);
        const bool flat = std::abs(row[m] - row[k]) < 1e-3;  // a level edge: all of it
        left = std::min({left, at, flat ? std::min(column[k], column[m]) : at});
        right = std::max({right, at, flat ? std::max(column[k], column[m]) : at});
      }
      const int from = static_cast<int>(std::clamp(std::floor(left - 1e-3), 0.0, static_cast<double>(raster_.columns)));
      const int to = static_cast<int>(std::clamp(std::ceil(right + 1e-3), -1.0, raster_.columns - 1.0));
      for (int c = from; c <= to; ++c) cell(t, pieces, whole, c, r, seen, static_cast<std::size_t>(r % kBand), tally);
    }
  }

  void cell(std::uint32_t t, const Pieces& pieces, const TriangleFrame& whole, int c, int r, std::vector<bool>& seen,
            std::size_t band_row, Tally& tally) const {
    const std::size_t bit = band_row * static_cast<std::size_t>(raster_.columns) + static_cast<std::size_t>(c);
    if (seen[bit] || (part_ != nullptr && !part_->only.get(c, r))) return;
    const double height = raster_.at(c, r);
    if (std::isnan(height)) return;
    const Vec2 p{cells_.x[static_cast<std::size_t>(c)], cells_.y[static_cast<std::size_t>(r)]};
    std::optional<double> error;
    if (!lattice_.empty()) {
      const auto& v = terrain_.tin.triangles[t];
      const Lattice &a = lattice_[v[0]], &b = lattice_[v[1]], &d = lattice_[v[2]];
      const Lattice at{c, -static_cast<std::int64_t>(r)};
      const std::int64_t ra = edge_function(b, d, at), sa = edge_function(d, a, at), ta = edge_function(a, b, at);
      if (ra < 0 || sa < 0 || ta < 0) return;
      if (terrain_.kind == SurfaceKind::linear) {
        const auto& z = terrain_.tin.heights;
        const double area2 = static_cast<double>(ra + sa + ta);
        error = std::abs(area2 * (height - z[v[0]]) - (static_cast<double>(sa) * (z[v[1]] - z[v[0]]) +
                                                       static_cast<double>(ta) * (z[v[2]] - z[v[0]]))) /
                area2;
      }
    } else {
      const Barycentric u = whole.barycentric(p);
      if (!(u.r >= kOutside && u.s >= kOutside && u.t >= kOutside)) return;
    }
    if (!terrain_.grid.has_data(p)) return;
    seen[bit] = true;
    const Jet jet = pieces.jet(p);
    if (!error) error = std::abs(jet.value - height);
    tally.add(raster_.index(c, r), *error);
    if (tolerance_ > 0 && *error > tolerance_ + allowance_) ++tally.violations;
    add_slope(jet.gradient, c, r, tally);
  }

  void add_slope(Vec2 gradient, int c, int r, Tally& tally) const {
    const Raster& around = part_ != nullptr ? *part_->around : raster_;
    if (part_ != nullptr) {
      c += part_->cells.column - part_->around_cells.column;
      r += part_->cells.row - part_->around_cells.row;
    }
    if (c == 0 || r == 0 || c == around.columns - 1 || r == around.rows - 1) return;
    const double dx = (around.at(c + 1, r) - around.at(c - 1, r)) / (2 * cells_.step_x);
    const double dy = (around.at(c, r - 1) - around.at(c, r + 1)) / (2 * cells_.step_y);
    if (std::isnan(dx) || std::isnan(dy)) return;
    ++tally.slopes;
    tally.slope_squares += norm2(gradient - Vec2{dx, dy});
  }

  const AssessedPart* part_;
  const Terrain& terrain_;
  const Raster& raster_;
  Cells cells_;
  EdgeTable edges_;
  std::vector<Lattice> lattice_;
  Bands bands_;
  double tolerance_, allowance_ = 0;
  RasterSummary summary_;
};

}  // namespace

ErrorReport assess(const Terrain& terrain, const Raster& raster, double tolerance, const Context& context) {
  if (raster.columns <= 0 || raster.rows <= 0) throw BadInput("the grid has no cells");
  return Assessment(terrain, raster, tolerance).run(context);
}

void assess_part(const AssessedPart& part, double tolerance, ErrorSums& sums, const Context& context) {
  const Raster& raster = *part.raster;
  for (int r = 0; r < raster.rows; ++r)
    for (int c = 0; c < raster.columns; ++c)
      if (part.only.get(c, r)) {
        ++sums.cells;
        sums.valid += raster.valid(c, r) ? 1 : 0;
      }
  if (part.terrain == nullptr) return;
  const Tally tally = Assessment(*part.terrain, raster, tolerance, &part).tally(context);
  if (tally.covered == 0) return;
  sums.covered += tally.covered;
  sums.violations += tally.violations;
  sums.slopes += tally.slopes;
  sums.squares += tally.squares;
  sums.slope_squares += tally.slope_squares;
  const auto columns = static_cast<std::size_t>(raster.columns);
  const std::size_t row = static_cast<std::size_t>(part.cells.row) + tally.largest_cell / columns;
  const std::size_t column = static_cast<std::size_t>(part.cells.column) + tally.largest_cell % columns;
  const std::size_t cell = row * static_cast<std::size_t>(sums.columns) + column;
  if (tally.largest < sums.largest || (tally.largest == sums.largest && cell > sums.largest_cell)) return;
  sums.largest = tally.largest;
  sums.largest_cell = cell;
}

ErrorReport report_of(const ErrorSums& sums) {
  if (sums.covered == 0) throw BadInput("no valid cell of the grid lies on the model: do they cover the same ground?");
  ErrorReport report;
  report.cells = sums.cells;
  report.valid_cells = sums.valid;
  report.uncovered = sums.valid - sums.covered;
  report.violations = sums.violations;
  report.rmse = std::sqrt(sums.squares / static_cast<double>(sums.covered));
  report.max_error = sums.largest;
  report.slope_rmse = sums.slopes ? std::sqrt(sums.slope_squares / static_cast<double>(sums.slopes)) : 0;
  return report;
}

}  // namespace retalho
