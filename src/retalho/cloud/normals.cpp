#include "retalho/cloud/normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>
#include <numeric>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"

namespace retalho {
namespace {

/// The points as nanoflann wants to see them.
struct Points {
  const std::vector<Vec3>& places;
  std::size_t kdtree_get_point_count() const { return places.size(); }
  double kdtree_get_pt(std::size_t k, std::size_t axis) const {
    return axis == 0 ? places[k].x : axis == 1 ? places[k].y : places[k].z;
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3, std::uint32_t>;

struct Link {
  float cost;
  std::uint32_t a, b;
  bool turned;  ///< b's normal has to be turned when a's stays
};

class Estimate {
 public:
  Estimate(std::vector<Vec3> places, std::size_t neighbours, const Context& context)
      : places_(std::move(places)), count_(std::min(neighbours, places_.size() - 1)), context_(context) {}

  void run(NormalNotes& notes) {
    find_planes(notes);
    orient(notes);
  }
  const std::vector<Vec3>& normals() const { return normals_; }

 private:
  void find_planes(NormalNotes& notes) {
    const Points points{places_};
    const Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    normals_.assign(places_.size(), Vec3{});
    near_.assign(places_.size() * count_, 0);
    std::vector<double> flatness(places_.size(), 0);
    parallel_chunks(places_.size(), 1024, context_, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> index(count_ + 1);
      std::vector<double> distance(count_ + 1);
      for (std::size_t k = begin; k < end; ++k) {
        const std::array<double, 3> at = {places_[k].x, places_[k].y, places_[k].z};
        const std::size_t found = tree.knnSearch(at.data(), count_ + 1, index.data(), distance.data());
        std::size_t n = 0;
        for (std::size_t i = 0; i < found && n < count_; ++i)
          if (index[i] != k) near_[k * count_ + n++] = index[i];
        fit_plane(k, flatness[k]);
      }
    });
    notes.flatness = std::accumulate(flatness.begin(), flatness.end(), 0.0) / static_cast<double>(places_.size());
  }

  void fit_plane(std::size_t k, double& flatness) {
    Vec3 mean = places_[k];
    for (std::size_t n = 0; n < count_; ++n) mean = mean + places_[near_[k * count_ + n]];
    mean = mean / static_cast<double>(count_ + 1);
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    const auto add = [&](Vec3 p) {
      const Eigen::Vector3d d(p.x - mean.x, p.y - mean.y, p.z - mean.z);
      spread += d * d.transpose();
    };
    add(places_[k]);
    for (std::size_t n = 0; n < count_; ++n) add(places_[near_[k * count_ + n]]);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    const Eigen::Vector3d values = solver.eigenvalues();
    if (!(values[1] > 1e-12 * values[2])) return;  // along a line, or all at one place: no plane
    const Eigen::Vector3d n = solver.eigenvectors().col(0);
    normals_[k] = {n[0], n[1], n[2]};
    flatness = 1 - std::max(0.0, values[0]) / values[1];
  }

  /// n seen in the mirror between the two points.
  static Vec3 mirrored(Vec3 n, Vec3 along) {
    const double length2 = norm2(along);
    return length2 > 0 ? n - (2 * dot(n, along) / length2) * along : n;
  }

  void orient(NormalNotes& notes) {
    std::vector<Link> links;
    links.reserve(near_.size());
    for (std::uint32_t a = 0; a < places_.size(); ++a)
      for (std::size_t n = 0; n < count_; ++n) {
        const std::uint32_t b = near_[a * count_ + n];
        if (norm2(normals_[a]) == 0 || norm2(normals_[b]) == 0) continue;
        const double match = dot(mirrored(normals_[a], places_[b] - places_[a]), normals_[b]);
        links.push_back({static_cast<float>(1 - std::abs(match)), a, b, match < 0});
      }
    std::sort(links.begin(), links.end(), [](const Link& l, const Link& r) {
      return l.cost != r.cost ? l.cost < r.cost : l.a != r.a ? l.a < r.a : l.b < r.b;
    });
    // Kruskal, with the turn against the part's root kept beside the parent.
    parent_.resize(places_.size());
    std::iota(parent_.begin(), parent_.end(), 0U);
    turned_.assign(places_.size(), 0);
    for (const Link& link : links) {
      const auto [ra, ta] = root(link.a);
      const auto [rb, tb] = root(link.b);
      if (ra == rb) continue;
      parent_[rb] = ra;
      turned_[rb] = static_cast<char>((ta != tb) != link.turned ? 1 : 0);
    }
    turn_outwards(notes);
    std::size_t pairs = 0, agreeing = 0;
    for (const Link& link : links) {
      const double match = dot(mirrored(normals_[link.a], places_[link.b] - places_[link.a]), normals_[link.b]);
      if (std::abs(match) < 0.5) continue;  // across an edge: neither way is wrong
      ++pairs;
      agreeing += match > 0 ? 1 : 0;
    }
    notes.agreement = pairs == 0 ? 0.5 : static_cast<double>(agreeing) / static_cast<double>(pairs);
  }

  std::pair<std::uint32_t, bool> root(std::uint32_t k) {
    std::uint32_t top = k;
    bool turned = false;
    while (parent_[top] != top) {
      turned = turned != (turned_[top] != 0);
      top = parent_[top];
    }
    const bool whole = turned;
    while (parent_[k] != top && k != top) {  // shorten the way, with the turns added up
      const std::uint32_t next = parent_[k];
      const bool own = turned_[k] != 0;
      parent_[k] = top;
      turned_[k] = turned ? 1 : 0;
      turned = turned != own;
      k = next;
    }
    return {top, whole};
  }

  /// Each part's outermost points in 26 directions vote for its side.
  void turn_outwards(NormalNotes& notes) {
    std::vector<std::uint32_t> part(places_.size());
    for (std::uint32_t k = 0; k < places_.size(); ++k) {
      const auto [top, turned] = root(k);
      part[k] = top;
      if (turned) normals_[k] = -normals_[k];
    }
    std::vector<std::uint32_t> number(places_.size(), ~0U);
    std::size_t parts = 0;
    for (std::uint32_t k = 0; k < places_.size(); ++k)
      if (norm2(normals_[k]) > 0 && number[part[k]] == ~0U) number[part[k]] = static_cast<std::uint32_t>(parts++);
    notes.parts = parts;
    std::vector<double> vote(parts, 0);
    for (int side = 0; side < 27; ++side) {
      const int east = side % 3 - 1, north = side / 3 % 3 - 1, up = side / 9 - 1;
      const Vec3 way = {static_cast<double>(east), static_cast<double>(north), static_cast<double>(up)};
      if (norm2(way) == 0) continue;
      std::vector<std::uint32_t> outermost(parts, ~0U);
      for (std::uint32_t k = 0; k < places_.size(); ++k) {
        if (norm2(normals_[k]) == 0) continue;
        std::uint32_t& best = outermost[number[part[k]]];
        if (best == ~0U || dot(places_[k], way) > dot(places_[best], way)) best = k;
      }
      for (std::size_t p = 0; p < parts; ++p) vote[p] += dot(normals_[outermost[p]], normalized(way));
    }
    for (std::uint32_t k = 0; k < places_.size(); ++k)
      if (norm2(normals_[k]) > 0 && vote[number[part[k]]] < 0) normals_[k] = -normals_[k];
  }

  std::vector<Vec3> places_;
  std::size_t count_;
  const Context& context_;
  std::vector<Vec3> normals_;
  std::vector<std::uint32_t> near_;  ///< `count_` a point
  std::vector<std::uint32_t> parent_;
  std::vector<char> turned_;
};

}  // namespace

std::vector<Vec3> estimate_normals(const std::vector<Vec3>& positions, const NormalOptions& options,
                                   NormalNotes* notes_out, const Context& context) {
  if (options.neighbours < 3 || options.neighbours > 200)
    throw UsageError("normals are estimated from 3 to 200 neighbours", {}, "--neighbours");
  NormalNotes notes;
  // Every place once, in the order of its first point.
  std::vector<std::uint32_t> order;
  for (std::uint32_t k = 0; k < positions.size(); ++k)
    if (std::isfinite(positions[k].x) && std::isfinite(positions[k].y) && std::isfinite(positions[k].z))
      order.push_back(k);
  const auto key = [&](std::uint32_t k) {
    return std::array<double, 3>{positions[k].x, positions[k].y, positions[k].z};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto ka = key(a), kb = key(b);
    return ka != kb ? ka < kb : a < b;
  });
  std::vector<Vec3> places;
  std::vector<std::uint32_t> place(positions.size(), ~0U);
  for (std::size_t n = 0; n < order.size(); ++n) {
    if (n == 0 || key(order[n]) != key(order[n - 1])) places.push_back(positions[order[n]]);
    place[order[n]] = static_cast<std::uint32_t>(places.size() - 1);
  }
  std::vector<Vec3> normals(positions.size());
  if (places.size() >= 3) {
    Estimate estimate(std::move(places), static_cast<std::size_t>(options.neighbours), context);
    estimate.run(notes);
    for (std::size_t k = 0; k < positions.size(); ++k)
      if (place[k] != ~0U) normals[k] = estimate.normals()[place[k]];
  }
  notes.undecided = static_cast<std::size_t>(
      std::count_if(normals.begin(), normals.end(), [](const Vec3& n) { return norm2(n) == 0; }));
  if (notes_out != nullptr) *notes_out = notes;
  return normals;
}

}  // namespace retalho
