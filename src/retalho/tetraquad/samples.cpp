#include "retalho/tetraquad/samples.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "retalho/core/parallel.h"

namespace retalho {
namespace {

constexpr std::size_t kGrain = 16384;

/// A stable counting sort: numbers 0 .. of_item.size() by `of_item`.
void sort_by(const std::vector<std::uint32_t>& of_item, std::size_t bins, std::vector<std::uint32_t>& order,
             std::vector<std::uint32_t>& first) {
  first.assign(bins + 1, 0);
  for (const std::uint32_t bin : of_item) ++first[bin + 1];
  for (std::size_t n = 0; n < bins; ++n) first[n + 1] += first[n];
  order.resize(of_item.size());
  std::vector<std::uint32_t> at(first.begin(), first.end() - 1);
  for (std::uint32_t k = 0; k < of_item.size(); ++k) order[at[of_item[k]]++] = k;
}

bool is_usable(Vec3 n, double length) {
  return std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z) && length > 1e-100 && std::isfinite(length);
}

}  // namespace

Sample Samples::operator[](std::size_t k) const {
  Sample sample{place(k), {}};
  if (cloud_->normals.size() != cloud_->positions.size()) return sample;
  const Vec3 n = cloud_->normals[number(k)];
  const double length = norm(n);
  if (is_usable(n, length)) sample.normal = n / length;
  return sample;
}

SampleRuns::SampleRuns(const Samples& samples, const TetMesh& mesh, const Context& context) : samples_(&samples) {
  std::vector<std::uint32_t> tet_of(samples.size());
  parallel_chunks(samples.size(), kGrain, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (mesh.forest) {
        tet_of[k] = mesh.tet_of_leaf.at(static_cast<std::uint32_t>(mesh.forest->locate(samples.place(k))));
        continue;
      }
      const TetPlace place = place_of(mesh.split, samples.place(k));
      std::size_t t = mesh.first_in_cell.at(cell_key(place.cell));
      while (t < mesh.places.size() && mesh.places[t] != place) ++t;
      if (t == mesh.places.size()) throw std::logic_error("SampleRuns: a sample outside of the mesh");
      tet_of[k] = static_cast<std::uint32_t>(t);
    }
  });
  sort_by(tet_of, mesh.tets.size(), order_, first_);
}

SampleBins::SampleBins(const Samples& samples, double edge) : samples_(&samples), edge_(edge) {
  std::vector<std::uint32_t> bin_of(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k)
    bin_of[k] =
        number_.try_emplace(cell_key(cube(samples.place(k))), static_cast<std::uint32_t>(number_.size())).first->second;
  sort_by(bin_of, number_.size(), order_, first_);
}

LatticePoint SampleBins::cube(Vec3 p) const {
  return {static_cast<std::int32_t>(std::floor(p.x / edge_)), static_cast<std::int32_t>(std::floor(p.y / edge_)),
          static_cast<std::int32_t>(std::floor(p.z / edge_))};
}

std::span<const std::uint32_t> SampleBins::in(const LatticePoint& cube) const {
  const auto at = number_.find(cell_key(cube));
  if (at == number_.end()) return {};
  return {order_.data() + first_[at->second], order_.data() + first_[at->second + 1]};
}

std::vector<TetPlace> occupied_places(const Samples& samples, TetSplit split, const Context& context) {
  const std::size_t chunks = (samples.size() + kGrain - 1) / kGrain;
  std::vector<std::vector<TetPlace>> found(chunks);
  parallel_chunks(samples.size(), kGrain, context, [&](std::size_t begin, std::size_t end) {
    std::vector<TetPlace>& own = found[begin / kGrain];
    own.reserve(end - begin);
    for (std::size_t k = begin; k < end; ++k) own.push_back(place_of(split, samples.place(k)));
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    own.shrink_to_fit();
  });
  std::vector<TetPlace> all;
  for (std::vector<TetPlace>& own : found) {  // kept short: joined as soon as it has doubled
    all.insert(all.end(), own.begin(), own.end());
    own = {};
    if (all.size() < 1000000) continue;
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace retalho
