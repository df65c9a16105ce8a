// The points of a fit: worked out from the cloud as they are asked for, and sorted by the tetrahedron that holds them.
// Ten million points cost 8 bytes each beside the cloud. Internal to the room.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "retalho/cloud/cloud.h"
#include "retalho/core/context.h"
#include "retalho/tetraquad/tet_mesh.h"

namespace retalho {

/// A point in lattice coordinates.
struct Sample {
  Vec3 place;
  Vec3 normal;  ///< unit, or zero: not known
};

/// Those points of a cloud that have finite coordinates. The cloud must outlive it.
class Samples {
 public:
  Samples() = default;
  /// `kept`: which of the cloud's points; empty: all.
  Samples(const PointCloud& cloud, std::vector<std::uint32_t> kept, Vec3 lattice_origin, double lattice_step)
      : origin(lattice_origin), step(lattice_step), cloud_(&cloud), kept_(std::move(kept)) {}

  Vec3 origin;
  double step = 1;

  std::size_t size() const { return cloud_ == nullptr ? 0 : kept_.empty() ? cloud_->positions.size() : kept_.size(); }
  Vec3 place(std::size_t k) const { return (cloud_->positions[number(k)] - origin) / step; }
  Sample operator[](std::size_t k) const;

 private:
  std::size_t number(std::size_t k) const { return kept_.empty() ? k : kept_[k]; }
  const PointCloud* cloud_ = nullptr;
  std::vector<std::uint32_t> kept_;
};

/// Which samples lie in which tetrahedron of a mesh.
class SampleRuns {
 public:
  SampleRuns() = default;
  /// Every sample must lie in a tetrahedron of the mesh. Both must outlive it. Cost: about 0.3 us a sample.
  SampleRuns(const Samples& samples, const TetMesh& mesh, const Context& context = {});

  /// Of the mesh that it was made for; 0 where there is no sample at all.
  std::size_t tets() const { return first_.empty() ? 0 : first_.size() - 1; }
  std::size_t size() const { return order_.size(); }
  /// Numbers of the tetrahedron's samples, ascending.
  std::span<const std::uint32_t> in(std::size_t tet) const {
    return {order_.data() + first_[tet], order_.data() + first_[tet + 1]};
  }
  const Samples& samples() const { return *samples_; }

 private:
  const Samples* samples_ = nullptr;
  std::vector<std::uint32_t> order_, first_;
};

/// The same by cubes of some size, to find those near a place.
class SampleBins {
 public:
  /// `edge`: of the cubes, in lattice units.
  SampleBins(const Samples& samples, double edge);
  /// Calls `visit(number)` for samples of all cubes that reach into the box of +-`radius` about `p`.
  template <typename Visit>
  void near(Vec3 p, double radius, const Visit& visit) const {
    const LatticePoint low = cube(p - Vec3{radius, radius, radius}), high = cube(p + Vec3{radius, radius, radius});
    for (std::int32_t i = low[0]; i <= high[0]; ++i)
      for (std::int32_t j = low[1]; j <= high[1]; ++j)
        for (std::int32_t k = low[2]; k <= high[2]; ++k)
          for (const std::uint32_t n : in({i, j, k})) visit(n);
  }
  const Samples& samples() const { return *samples_; }

 private:
  LatticePoint cube(Vec3 p) const;
  std::span<const std::uint32_t> in(const LatticePoint& cube) const;

  const Samples* samples_;
  double edge_;
  std::unordered_map<std::uint64_t, std::uint32_t> number_;  ///< of a cube, by its key
  std::vector<std::uint32_t> order_, first_;
};

/// The tetrahedra of the full grid that hold points, ascending.
std::vector<TetPlace> occupied_places(const Samples& samples, TetSplit split, const Context& context);

}  // namespace retalho
