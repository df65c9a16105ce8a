#include "retalho/tetraquad/adaptive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "retalho/core/error.h"
#include "retalho/tetraquad/fit_parts.h"
#include "retalho/tetraquad/growth.h"

namespace retalho {
namespace {

constexpr int kPasses = 24;

/// All cubes of the box and one more on each side: a surface that is to be closed may have to be followed anywhere.
void fill_box(std::vector<LatticePoint>& cubes) {
  LatticePoint low = cubes[0], high = low;
  for (const LatticePoint& cube : cubes)
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], cube[d]);
      high[d] = std::max(high[d], cube[d]);
    }
  cubes.clear();
  for (std::int32_t i = low[0] - 1; i <= high[0] + 1; ++i)
    for (std::int32_t j = low[1] - 1; j <= high[1] + 1; ++j)
      for (std::int32_t k = low[2] - 1; k <= high[2] + 1; ++k) cubes.push_back({i, j, k});
}

class AdaptiveFit {
 public:
  AdaptiveFit(const PointCloud& cloud, const TetraQuadAdaptiveOptions& adaptive, const TetraQuadFitOptions& options,
              TetraQuadFitReport& report, const Context& context)
      : cloud_(cloud), adaptive_(adaptive), options_(options), report_(report), context_(context) {
    TetraQuadFitOptions roots = options;
    roots.resolution = adaptive.roots;
    roots.split = TetSplit::kuhn;
    samples_ = take_samples(cloud, roots, report);
    const std::vector<TetPlace> places = occupied_places(samples_, TetSplit::kuhn, context);
    constexpr double unit = TetForest::kUnit;
    samples_.step /= unit;
    georef_ = cloud.georef;
    std::vector<LatticePoint> cubes;
    for (const TetPlace& place : places)
      for (int side = 0; side < 27; ++side)
        cubes.push_back({place.cell[0] + side % 3 - 1, place.cell[1] + side / 3 % 3 - 1, place.cell[2] + side / 9 - 1});
    if (options.closed) fill_box(cubes);
    forest_ = TetForest(std::move(cubes));
    // The area that holds points, counted in cubes of a quarter of a root's edge.
    std::set<LatticePoint> cells;
    constexpr double coarse = unit / 4;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      const Vec3 p = samples_.place(k);
      cells.insert({static_cast<std::int32_t>(std::floor(p.x / coarse)),
                    static_cast<std::int32_t>(std::floor(p.y / coarse)),
                    static_cast<std::int32_t>(std::floor(p.z / coarse))});
    }
    if (options.solver != TetraQuadSolver::cholesky) bins_.emplace(samples_, unit / 8);
    weights_ = weights_of(options, static_cast<double>(cells.size()) * coarse * coarse, samples_.size());
  }

  TetraQuad run() {
    // Without a tolerance the budget is spent, about a vertex of the band for six of its coefficients, where there are
    // points enough.
    if (adaptive_.max_error == 0)
      check_need(std::min(adaptive_.coefficients / 6, samples_.size()), samples_.size(), options_, "adaptive");
    for (int level = 0; level < adaptive_.start_level; ++level) {
      const auto counts = count_samples();
      std::vector<std::uint32_t> chosen;
      for (const std::uint32_t leaf : band(counts))
        if (forest_.nodes()[leaf].level <= level) chosen.push_back(leaf);
      forest_.bisect(chosen);
    }
    TetraQuad surface = fit(nullptr);
    for (int pass = 1; pass < kPasses; ++pass) {
      if (adaptive_.max_error > 0 && report_.residual_quantile <= adaptive_.max_error) break;
      const std::vector<std::uint32_t> chosen = mark(surface);
      if (chosen.empty()) break;
      const TetForest before = forest_;
      forest_.bisect(chosen);
      TetraQuadFitReport last = report_;
      TetraQuad next = fit(&surface);
      if (report_.coefficients > adaptive_.coefficients) {
        forest_ = before;
        report_ = std::move(last);
        break;
      }
      surface = std::move(next);
      report_.growth_rounds = 0;
    }
    finish(surface);
    if (report_.coefficients > adaptive_.coefficients + adaptive_.coefficients / 50)
      report_.warnings.push_back(
          fmt::format("the coarsest mesh already has {} coefficients, more than {}: fewer root cubes or a lower start "
                      "level would do",
                      report_.coefficients, adaptive_.coefficients));
    if (adaptive_.max_error > 0 && report_.residual_quantile > adaptive_.max_error)
      report_.warnings.push_back(fmt::format(
          "{:.4g} is not reached with {} coefficients: {:.4g} % of the points are "
          "within {:.4g}",
          adaptive_.max_error, adaptive_.coefficients, 100 * adaptive_.quantile, report_.residual_quantile));
    return surface;
  }

 private:
  /// Points in each leaf that holds any.
  std::map<std::uint32_t, std::size_t> count_samples() const {
    std::map<std::uint32_t, std::size_t> counts;
    for (std::size_t k = 0; k < samples_.size(); ++k)
      if (const std::int64_t leaf = forest_.locate(samples_.place(k)); leaf >= 0)
        ++counts[static_cast<std::uint32_t>(leaf)];
    return counts;
  }

  /// Leaves with points, and those that have three vertices of them.
  std::vector<std::uint32_t> band(const std::map<std::uint32_t, std::size_t>& counts) const {
    std::vector<char> near(forest_.vertices().size(), 0);
    for (const auto& [leaf, count] : counts)
      for (const std::uint32_t v : forest_.nodes()[leaf].corners) near[v] = 1;
    std::vector<std::uint32_t> found;
    for (const std::uint32_t leaf : forest_.leaves()) {
      const TetCorners& corners = forest_.nodes()[leaf].corners;
      if (std::count_if(corners.begin(), corners.end(), [&](std::uint32_t v) { return near[v] != 0; }) >= 3)
        found.push_back(leaf);
    }
    return found;
  }

  const SampleBins* bins() const { return bins_ ? &*bins_ : nullptr; }

  /// `before`: the pass before this one, or null.
  TetraQuad fit(const TetraQuad* before) {
    context_.check();
    TetraQuad surface;
    surface.georef = georef_;
    surface.mesh =
        make_tet_mesh(samples_.origin, samples_.step, std::make_shared<TetForest>(forest_), band(count_samples()));
    check_need(surface.mesh.lattice.size(), samples_.size(), options_, "adaptive");
    const HalfFaces faces(surface.mesh.tets, surface.mesh.lattice.size());
    const SampleRuns runs(samples_, surface.mesh, context_);
    solve_surface(surface, faces, runs, bins(), before, weights_, options_, report_, context_);
    measure(TetraQuadField(surface), runs, {.max_error = adaptive_.max_error, .quantile = adaptive_.quantile}, report_);
    return surface;
  }

  /// The leaves round the edges whose cut promises most.
  std::vector<std::uint32_t> mark(const TetraQuad& surface) const {
    struct Edge {
      double sum = 0;
      std::vector<std::uint32_t> leaves;
    };
    const TetraQuadField field(surface);
    std::map<std::uint32_t, std::pair<double, std::size_t>> residual;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      TetBarycentric b;
      const auto leaf = static_cast<std::uint32_t>(forest_.locate(samples_.place(k), &b));
      auto& [sum, count] = residual[leaf];
      sum += std::abs(evaluate(field.ordinates(surface.mesh.tet_of_leaf.at(leaf)), b));
      ++count;
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, Edge> edges;
    double total = 0;
    for (const auto& [leaf, entry] : residual) {
      const TetForest::Node& node = forest_.nodes()[leaf];
      if (entry.second < adaptive_.fewest || node.level >= TetForest::kDeepest) continue;
      const std::uint32_t a = node.corners[0], b = node.corners[node.tag()];
      Edge& edge = edges[{std::min(a, b), std::max(a, b)}];
      edge.sum += entry.first;
      edge.leaves.push_back(leaf);
      total += entry.first;
    }
    std::vector<const Edge*> order;
    order.reserve(edges.size());
    for (const auto& [key, edge] : edges) order.push_back(&edge);
    std::stable_sort(order.begin(), order.end(), [](const Edge* a, const Edge* b) { return a->sum > b->sum; });
    // Each cut adds a vertex, and closing the mesh some more: not more than the budget has room for.
    const std::size_t room =
        adaptive_.coefficients > report_.coefficients ? adaptive_.coefficients - report_.coefficients : 0;
    const std::size_t most = room / 19;
    if (most < 5) return {};
    std::vector<std::uint32_t> chosen;
    double sum = 0;
    for (std::size_t n = 0; n < order.size() && n < most && sum < adaptive_.share * total; ++n) {
      sum += order[n]->sum;
      chosen.insert(chosen.end(), order[n]->leaves.begin(), order[n]->leaves.end());
    }
    return chosen;
  }

  /// Sheets that no point asks for go, small holes close.
  void finish(TetraQuad& surface) {
    const auto counts = count_samples();
    const std::vector<std::uint32_t> leaves = forest_.leaves();
    std::unordered_map<std::uint32_t, std::uint32_t> number;
    std::vector<TetCorners> corners;
    for (const std::uint32_t leaf : leaves) {
      number.emplace(leaf, static_cast<std::uint32_t>(corners.size()));
      corners.push_back(forest_.nodes()[leaf].corners);
    }
    const HalfFaces all(std::move(corners), forest_.vertices().size());
    const auto shared = surface.mesh.forest;
    std::vector<std::uint32_t> active = leaves_of(surface.mesh);
    active = kept(surface, active, counts);
    surface = moved_to(surface, make_tet_mesh(samples_.origin, samples_.step, shared, active), nullptr);
    const std::unordered_set<std::uint32_t> own(active.begin(), active.end());
    std::unordered_set<std::uint64_t> own_vertices;
    for (const LatticePoint& v : surface.mesh.lattice) own_vertices.insert(cell_key(v));

    std::optional<ClosedGuide> guide;
    if (options_.closed && !open_faces(surface, HalfFaces(surface.mesh.tets, surface.mesh.lattice.size())).empty())
      guide.emplace(make_guide(cloud_, guide_options(), context_));
    for (int round = 0; round < (guide ? kClosingRounds : adaptive_.growth); ++round) {
      const HalfFaces faces(surface.mesh.tets, surface.mesh.lattice.size());
      std::vector<std::uint32_t> grown = leaves_of(surface.mesh);
      std::unordered_set<std::uint32_t> in(grown.begin(), grown.end());
      const std::size_t before = grown.size();
      for (const std::uint32_t f : open_faces(surface, faces)) {
        const std::int64_t beyond = all.neighbour(number.at(grown[f / 4]), f % 4);
        if (beyond < 0) continue;
        for (const std::uint32_t v : all.corners(static_cast<std::size_t>(beyond)))
          for (const std::uint32_t t : all.star(v))
            if (in.insert(leaves[t]).second) grown.push_back(leaves[t]);
      }
      if (grown.size() == before) break;
      ++report_.growth_rounds;
      surface = moved_to(surface, make_tet_mesh(samples_.origin, samples_.step, shared, grown), nullptr);
      std::vector<char> is_new(surface.quadrics.size(), 0);
      for (std::size_t v = 0; v < is_new.size(); ++v)
        is_new[v] = own_vertices.contains(cell_key(surface.mesh.lattice[v])) ? 0 : 1;
      solve_added(surface, HalfFaces(surface.mesh.tets, surface.mesh.lattice.size()), is_new, bins(),
                  guide ? &*guide : nullptr, weights_, options_, context_);
    }
    take_back(surface, own);
    active = kept(surface, leaves_of(surface.mesh), counts);
    std::sort(active.begin(), active.end(),
              [&](std::uint32_t a, std::uint32_t b) { return number.at(a) < number.at(b); });
    surface = moved_to(surface, make_tet_mesh(samples_.origin, samples_.step, shared, active), nullptr);
    report_.open_faces = open_faces(surface, HalfFaces(surface.mesh.tets, surface.mesh.lattice.size())).size();
    measure(TetraQuadField(surface), SampleRuns(samples_, surface.mesh, context_),
            {.max_error = adaptive_.max_error, .quantile = adaptive_.quantile}, report_);
  }

  /// About as fine as the mesh is on the whole.
  TetraQuadFitOptions guide_options() const {
    TetraQuadFitOptions grid = options_;
    grid.resolution = 48;
    return grid;
  }

  /// Without those whose piece of the surface hangs together with none that holds points.
  std::vector<std::uint32_t> kept(const TetraQuad& surface, const std::vector<std::uint32_t>& leaves,
                                  const std::map<std::uint32_t, std::size_t>& counts) {
    const TetraQuadField field(surface);
    std::vector<char> seeds(leaves.size());
    for (std::size_t t = 0; t < leaves.size(); ++t) seeds[t] = counts.contains(leaves[t]) ? 1 : 0;
    const std::vector<char> reached =
        hanging_together(field, HalfFaces(surface.mesh.tets, surface.mesh.lattice.size()), std::move(seeds));
    std::vector<std::uint32_t> found;
    for (std::size_t t = 0; t < leaves.size(); ++t)
      if (reached[t] != 0 || !field.may_cross(t))
        found.push_back(leaves[t]);
      else
        ++report_.stray;
    return found;
  }

  /// Of what was added, only what closes a hole: nothing that an open face hangs together with.
  void take_back(TetraQuad& surface, const std::unordered_set<std::uint32_t>& own) const {
    const std::vector<std::uint32_t> leaves = leaves_of(surface.mesh);
    // Spread among the added ones alone: on a mesh of theirs.
    std::vector<std::uint32_t> added;
    for (const std::uint32_t leaf : leaves)
      if (!own.contains(leaf)) added.push_back(leaf);
    if (added.empty()) return;
    const HalfFaces faces(surface.mesh.tets, surface.mesh.lattice.size());
    std::unordered_set<std::uint32_t> open;
    for (const std::uint32_t f : open_faces(surface, faces))
      if (!own.contains(leaves[f / 4])) open.insert(leaves[f / 4]);
    const TetraQuad part =
        moved_to(surface, make_tet_mesh(samples_.origin, samples_.step, surface.mesh.forest, added), nullptr);
    std::vector<char> seeds(added.size());
    for (std::size_t t = 0; t < added.size(); ++t) seeds[t] = open.contains(added[t]) ? 1 : 0;
    const TetraQuadField field(part);
    const std::vector<char> bad =
        hanging_together(field, HalfFaces(part.mesh.tets, part.mesh.lattice.size()), std::move(seeds));
    std::vector<std::uint32_t> good;
    for (const std::uint32_t leaf : leaves)
      if (own.contains(leaf)) good.push_back(leaf);
    for (std::size_t t = 0; t < added.size(); ++t)
      if (bad[t] == 0 && field.may_cross(t)) good.push_back(added[t]);
    surface = moved_to(surface, make_tet_mesh(samples_.origin, samples_.step, surface.mesh.forest, good), nullptr);
  }

  const PointCloud& cloud_;
  const TetraQuadAdaptiveOptions& adaptive_;
  const TetraQuadFitOptions& options_;
  TetraQuadFitReport& report_;
  const Context& context_;
  Georef georef_;
  Samples samples_;
  std::optional<SampleBins> bins_;
  TetForest forest_;
  EnergyWeights weights_;
};

}  // namespace

TetraQuad fit_tetraquad_adaptive(const PointCloud& cloud, const TetraQuadAdaptiveOptions& adaptive,
                                 const TetraQuadFitOptions& options, TetraQuadFitReport* report_out,
                                 const Context& context) {
  check_options(options);
  if (adaptive.roots < 2 || adaptive.roots > 64 || adaptive.start_level < 0 || adaptive.start_level > 12 ||
      !(adaptive.share > 0 && adaptive.share <= 1) || adaptive.fewest < 1 || adaptive.coefficients < 100 ||
      !(adaptive.max_error >= 0) || !(adaptive.quantile > 0 && adaptive.quantile <= 1))
    throw UsageError("the options of the adaptive fit are out of range", {}, "--adaptive");
  TetraQuadFitReport report;
  TetraQuad surface = AdaptiveFit(cloud, adaptive, options, report, context).run();
  if (report_out != nullptr) *report_out = std::move(report);
  return surface;
}

}  // namespace retalho
