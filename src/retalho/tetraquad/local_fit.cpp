#include "retalho/tetraquad/local_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "retalho/core/parallel.h"

namespace retalho {
namespace {

constexpr std::size_t kFewest = 12, kMost = 600;

Vec3 lattice_place(const TetMesh& mesh, std::size_t v) {
  const LatticePoint& l = mesh.lattice[v];
  return {static_cast<double>(l[0]), static_cast<double>(l[1]), static_cast<double>(l[2])};
}

/// Value, gradient and second derivatives at `centre`, as a polynomial in (p - centre) / size, of the quadratic that is
/// nearest to the samples. `radius`, like all lengths here, in lattice units.
Eigen::Matrix<double, 10, 1> best_quadratic(const Samples& samples, const std::vector<std::uint32_t>& near, Vec3 centre,
                                            double size, double radius) {
  Eigen::Matrix<double, 10, 10> square = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1> right = Eigen::Matrix<double, 10, 1>::Zero();
  double total = 0;
  for (const std::uint32_t k : near) {
    const Sample s = samples[k];
    const Vec3 d = (s.place - centre) / size;
    const double far = std::min(1.0, norm2(s.place - centre) / (radius * radius));
    const double weight = (1 - far) * (1 - far) + 1e-3;
    total += weight;
    Eigen::Matrix<double, 10, 4> rows;
    rows.col(0) << 1, d.x, d.y, d.z, d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.x * d.z, d.y * d.z;
    rows.col(1) << 0, 1, 0, 0, 2 * d.x, 0, 0, d.y, d.z, 0;
    rows.col(2) << 0, 0, 1, 0, 0, 2 * d.y, 0, d.x, 0, d.z;
    rows.col(3) << 0, 0, 0, 1, 0, 0, 2 * d.z, 0, d.x, d.y;
    const bool has_normal = norm2(s.normal) > 0;
    if (!has_normal) rows.rightCols<3>().setZero();
    square.noalias() += weight * rows * rows.transpose();
    if (has_normal)
      right.noalias() += weight * rows.rightCols<3>() * Eigen::Vector3d(s.normal.x, s.normal.y, s.normal.z);
  }
  // What the points leave open stays small: curvature first.
  for (Eigen::Index i = 0; i < 10; ++i) square(i, i) += total * (i < 4 ? 1e-9 : 1e-5);
  return square.ldlt().solve(right);
}

}  // namespace

std::vector<double> vertex_sizes(const TetMesh& mesh) {
  if (!mesh.forest) return {};
  std::vector<double> logs(mesh.lattice.size(), 0);
  std::vector<int> count(mesh.lattice.size(), 0);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const double log = std::log(mesh.size(t));
    for (const std::uint32_t v : mesh.tets[t]) {
      logs[v] += log;
      ++count[v];
    }
  }
  for (std::size_t v = 0; v < logs.size(); ++v) logs[v] = std::exp(logs[v] / count[v]);
  return logs;
}

void fit_locally(const SampleBins& bins, const TetMesh& mesh, const std::vector<char>& marked,
                 std::span<const double> sizes, std::vector<Quadric>& quadrics, const Context& context) {
  const Samples& samples = bins.samples();
  parallel_chunks(mesh.lattice.size(), 64, context, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    for (std::size_t v = begin; v < end; ++v) {
      if (marked[v] == 0) continue;
      const Vec3 centre = lattice_place(mesh, v);
      const double size = sizes.empty() ? 1 : sizes[v];
      double radius = size;
      for (int widening = 0; widening < 12; ++widening, radius *= 1.5) {
        near.clear();
        bins.near(centre, radius, [&](std::uint32_t k) {
          if (norm2(samples.place(k) - centre) <= radius * radius) near.push_back(k);
        });
        if (near.size() >= std::min(kFewest, samples.size())) break;
      }
      if (near.size() > kMost) {  // evenly, whatever their order
        const std::size_t stride = (near.size() + kMost - 1) / kMost;
        std::size_t n = 0;
        std::erase_if(near, [&](std::uint32_t) { return n++ % stride != 0; });
      }
      const auto taylor = best_quadratic(samples, near, centre, size, radius);
      // The normals made a function with unit gradient in lattice units, measured in units of `size`.
      for (std::size_t i = 0; i < 10; ++i) {
        const double factor = i == 0 ? size : i < 4 ? 2.0 / 3 : 1 / (3 * size);
        quadrics[v][i] = factor * taylor[static_cast<Eigen::Index>(i)];
      }
    }
  });
}

namespace {

/// `forest`: the one of `other`, bisected further.
std::vector<char> start_from_coarser(const TetraQuad& other, const TetForest& forest, const TetMesh& mesh,
                                     std::vector<Quadric>& quadrics) {
  const auto numbers = [&](const TetMesh& of) {
    std::unordered_map<std::uint64_t, std::uint32_t> number;
    for (std::uint32_t v = 0; v < of.lattice.size(); ++v) number.emplace(cell_key(of.lattice[v]), v);
    return number;
  };
  const std::vector<LatticePoint>& places = forest.vertices();
  std::vector<Quadric> known(places.size());
  std::vector<char> is_known(places.size(), 0);
  const auto before = numbers(other.mesh);
  for (std::size_t v = 0; v < places.size(); ++v)
    if (const auto at = before.find(cell_key(places[v])); at != before.end()) {
      known[v] = other.quadrics[at->second];
      is_known[v] = 1;
    }
  const auto way = [&](std::uint32_t from, std::uint32_t to) {
    return Vec3{static_cast<double>(places[to][0] - places[from][0]),
                static_cast<double>(places[to][1] - places[from][1]),
                static_cast<double>(places[to][2] - places[from][2])};
  };
  for (const TetForest::Node& node : forest.nodes()) {  // an edge's ends are older than its middle
    if (node.child < 0) continue;
    const std::uint32_t a = node.corners[0], b = node.corners[node.tag()],
                        middle = forest.nodes()[static_cast<std::size_t>(node.child)].corners[node.tag()];
    if (is_known[middle] != 0 || is_known[a] == 0 || is_known[b] == 0) continue;
    const Quadric one = shifted(known[a], way(a, middle)), two = shifted(known[b], way(b, middle));
    for (std::size_t n = 0; n < 10; ++n) known[middle][n] = 0.5 * (one[n] + two[n]);
    is_known[middle] = 1;
  }
  const auto wanted = numbers(mesh);
  std::vector<char> left(mesh.lattice.size(), 1);
  for (std::size_t v = 0; v < places.size(); ++v)
    if (const auto at = wanted.find(cell_key(places[v])); at != wanted.end() && is_known[v] != 0) {
      quadrics[at->second] = known[v];
      left[at->second] = 0;
    }
  return left;
}

}  // namespace

std::vector<char> start_from(const TetraQuad& other, const TetMesh& mesh, std::vector<Quadric>& quadrics) {
  quadrics.assign(mesh.lattice.size(), Quadric{});
  if (mesh.forest && other.mesh.forest) return start_from_coarser(other, *mesh.forest, mesh, quadrics);
  std::vector<char> left(mesh.lattice.size(), 0);
  const TetraQuadField field(other);
  for (std::size_t v = 0; v < mesh.lattice.size(); ++v) {
    const auto jet = field.jet(mesh.position(v));
    if (!jet) {
      left[v] = 1;
      continue;
    }
    quadrics[v] = interpolating_quadric(*jet, mesh.step);
  }
  return left;
}

}  // namespace retalho
