// Greedy refinement over scattered points: who is worst served comes next.
#include <algorithm>
#include <cmath>
#include <queue>

#include "retalho/tin/predicates.h"
#include "retalho/tin/scattered.h"
#include "retalho/tin/scattered_mesh.h"
#include "retalho/tin/scattered_places.h"

namespace retalho {
namespace {

struct Candidate {
  double error;
  std::uint32_t place, triangle;
  /// Last in the queue: smaller errors, then later places.
  friend bool operator<(const Candidate& a, const Candidate& b) {
    return a.error != b.error ? a.error < b.error : a.place > b.place;
  }
};

/// |height of the place - height of the flat triangle there|. Weights are clamped and scaled to sum 1, so that the
/// flat height stays between the corners' heights on the thinnest triangle.
double flat_error(const Places& places, const std::array<std::uint32_t, 3>& v, std::uint32_t place) {
  const Vec2 q = places.at[place];
  const Vec2 a = places.at[v[0]] - q, b = places.at[v[1]] - q, c = places.at[v[2]] - q;
  const double wa = std::max(cross(b, c), 0.0), wb = std::max(cross(c, a), 0.0), wc = std::max(cross(a, b), 0.0);
  const double z = places.heights[place], sum = wa + wb + wc;
  if (!(sum > 0)) return std::abs(z - places.heights[v[0]]);  // all three underflow: a place on a corner
  return std::abs(
      (wa * (places.heights[v[0]] - z) + wb * (places.heights[v[1]] - z) + wc * (places.heights[v[2]] - z)) / sum);
}

class Refinement {
 public:
  Refinement(const Places& places, const PointRefineOptions& options)
      : places_(places),
        options_(options),
        hull_(convex_hull(places.at)),
        mesh_(start()),
        next_(places.at.size(), kNone),
        vertex_(places.at.size(), false) {
    for (const std::uint32_t corner : hull_) vertex_[corner] = true;
    vertices_ = hull_.size();
    insert_hull();
    distribute();
  }

  void run(const Context& context) {
    double first = 0;
    for (std::size_t steps = 0; !queue_.empty(); ++steps) {
      if (options_.vertices > 0 && vertices_ >= options_.vertices) return;
      const Candidate worst = queue_.top();
      queue_.pop();
      if (worst_place_[worst.triangle] != worst.place || worst_error_[worst.triangle] != worst.error) continue;
      if (steps % 4096 == 0) {
        context.check();
        first = std::max(first, worst.error);
        context.report("refine", options_.vertices > 0
                                     ? static_cast<double>(vertices_) / static_cast<double>(options_.vertices)
                                     : 1 - (worst.error - options_.max_error) / first);
      }
      insert(worst);
    }
  }

  double max_error() const {
    double largest = 0;
    for (const double error : worst_error_) largest = std::max(largest, error);
    return largest;
  }
  const ScatteredMesh& mesh() const { return mesh_; }
  const std::vector<bool>& chosen() const { return vertex_; }

 private:
  ScatteredMesh start() {
    // Three corners far apart along the hull: any three are not on one line.
    const std::size_t n = hull_.size();
    return ScatteredMesh(places_.at, hull_[0], hull_[n / 3], hull_[2 * n / 3],
                         std::min(places_.at.size(), options_.vertices ? options_.vertices : places_.at.size() / 4));
  }

  void insert_hull() {
    const std::size_t n = hull_.size();
    std::vector<bool> waits(places_.at.size(), false);
    for (std::size_t k = 0; k < n; ++k) waits[hull_[k]] = k != 0 && k != n / 3 && k != 2 * n / 3;
    std::uint32_t hint = 0;
    for (const std::uint32_t place : insertion_order(places_.at.size()))
      if (waits[place]) hint = mesh_.insert(place, hint);
  }

  /// Gives every place that is no vertex to the triangle that holds it.
  void distribute() {
    head_.assign(mesh_.triangles().size(), kNone);
    worst_place_.assign(mesh_.triangles().size(), kNone);
    worst_error_.assign(mesh_.triangles().size(), 0);
    std::uint32_t hint = 0;
    for (auto place = static_cast<std::uint32_t>(places_.at.size()); place-- > 0;) {
      if (vertex_[place]) continue;
      hint = mesh_.locate(places_.at[place], hint);
      give(place, hint);
    }
    for (std::uint32_t t = 0; t < head_.size(); ++t) enqueue(t);
  }

  void give(std::uint32_t place, std::uint32_t triangle) {
    next_[place] = head_[triangle];
    head_[triangle] = place;
    const double error = flat_error(places_, mesh_.triangles()[triangle].v, place);
    const std::uint32_t best = worst_place_[triangle];
    if (best == kNone || error > worst_error_[triangle] || (error == worst_error_[triangle] && place < best)) {
      worst_place_[triangle] = place;
      worst_error_[triangle] = error;
    }
  }

  void enqueue(std::uint32_t triangle) {
    if (worst_place_[triangle] != kNone && worst_error_[triangle] > options_.max_error)
      queue_.push({worst_error_[triangle], worst_place_[triangle], triangle});
  }

  void insert(const Candidate& worst) {
    mesh_.insert(worst.place, worst.triangle);
    vertex_[worst.place] = true;
    ++vertices_;
    const auto& star = mesh_.star();
    head_.resize(mesh_.triangles().size(), kNone);
    worst_place_.resize(head_.size(), kNone);
    worst_error_.resize(head_.size(), 0);
    heads_.clear();
    for (const std::uint32_t t : star) {
      if (head_[t] != kNone) heads_.push_back(head_[t]);
      head_[t] = worst_place_[t] = kNone;
      worst_error_[t] = 0;
    }
    std::size_t wedge = 0;
    while (mesh_.is_ghost(star[wedge])) ++wedge;
    for (const std::uint32_t first : heads_)
      for (std::uint32_t place = first, after; place != kNone; place = after) {
        after = next_[place];
        if (place == worst.place) continue;
        wedge = find_wedge(star, places_.at[worst.place], places_.at[place], wedge);
        give(place, star[wedge]);
      }
    for (const std::uint32_t t : star) enqueue(t);
  }

  /// Turns around the new vertex p until q lies between the two spokes of a triangle. The star's triangles are
  /// (p, from, to) counter-clockwise, and q lies in one of them.
  std::size_t find_wedge(const std::vector<std::uint32_t>& star, Vec2 p, Vec2 q, std::size_t wedge) const {
    for (;;) {
      const auto& v = mesh_.triangles()[star[wedge]].v;
      if (v[1] == ScatteredMesh::kGhost || orientation(p, places_.at[v[1]], q) < 0)
        wedge = wedge == 0 ? star.size() - 1 : wedge - 1;
      else if (v[2] == ScatteredMesh::kGhost || orientation(p, places_.at[v[2]], q) > 0)
        wedge = wedge + 1 == star.size() ? 0 : wedge + 1;
      else
        return wedge;
    }
  }

  const Places& places_;
  const PointRefineOptions& options_;
  std::vector<std::uint32_t> hull_;
  ScatteredMesh mesh_;
  std::vector<std::uint32_t> next_;  // list of the places of one triangle
  std::vector<bool> vertex_;
  std::vector<std::uint32_t> head_, worst_place_;  // by triangle
  std::vector<double> worst_error_;                // by triangle
  std::vector<std::uint32_t> heads_;               // scratch
  std::priority_queue<Candidate> queue_;           // entries whose triangle has changed since are passed over
  std::size_t vertices_ = 0;
};

}  // namespace

Tin refine_points(std::span<const Vec3> points, const PointRefineOptions& options, ScatteredNotes* notes,
                  const Context& context) {
  ScatteredNotes own;
  ScatteredNotes& into = notes ? *notes : own;
  const Places places = make_places(points, into);
  Refinement refinement(places, options);
  refinement.run(context);
  into.max_error = refinement.max_error();

  std::vector<std::uint32_t> vertex(places.at.size(), kNone);
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < vertex.size(); ++k)
    if (refinement.chosen()[k]) vertex[k] = count++;
  return to_tin(refinement.mesh(), places, vertex, count);
}

}  // namespace retalho
