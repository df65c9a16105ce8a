#include "retalho/tetraquad/growth.h"

#include <algorithm>
#include <unordered_map>

namespace retalho {
namespace {

/// Does the function change its sign on the face opposite to `corner`?
bool crosses_face(const TetCubic& c, std::size_t corner) {
  bool below = false, above = false;
  for (std::size_t n = 0; n < 20; ++n) {
    const auto& at = kTet.cubic[n];
    if (std::any_of(at.begin(), at.end(), [&](int i) { return i == static_cast<int>(corner); })) continue;
    (c[n] < 0 ? below : above) = true;
  }
  if (!below || !above) return false;  // proved by the ordinates
  constexpr int parts = 6;
  below = above = false;
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j) {
      const std::array<double, 3> weights = {static_cast<double>(i) / parts, static_cast<double>(j) / parts,
                                             static_cast<double>(parts - i - j) / parts};
      TetBarycentric b{};
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != corner) b[k] = weights[n++];
      (evaluate(c, b) < 0 ? below : above) = true;
      if (below && above) return true;
    }
  return false;
}

bool is_near(const LatticePoint& cell, const std::vector<LatticePoint>& data, int reach) {
  LatticePoint probe{};
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -reach; k <= reach; ++k) {
        probe = {cell[0] + i, cell[1] + j, cell[2] + k};
        if (std::binary_search(data.begin(), data.end(), probe)) return true;
      }
  return false;
}

/// The quadrics of the vertices that `is_new` names, from the tetrahedra around them.
void solve_new(TetraQuad& surface, const HalfFaces& faces, const std::vector<char>& is_new,
               const EnergyWeights& weights, const Context& context) {
  const TetMesh& mesh = surface.mesh;
  std::vector<TetPlace> around;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (std::none_of(mesh.tets[t].begin(), mesh.tets[t].end(), [&](std::uint32_t v) { return is_new[v] != 0; }))
      continue;
    around.push_back(mesh.places[t]);
    for (std::size_t i = 0; i < 4; ++i)
      if (const std::int64_t o = faces.neighbour(t, i); o >= 0)
        around.push_back(mesh.places[static_cast<std::size_t>(o)]);
  }
  const TetMesh part = make_tet_mesh(mesh.origin, mesh.step, mesh.split, std::move(around));
  std::unordered_map<std::uint64_t, std::uint32_t> whole;
  for (std::uint32_t v = 0; v < mesh.lattice.size(); ++v) whole.emplace(cell_key(mesh.lattice[v]), v);
  const Energy energy = assemble_energy(part, HalfFaces(part.tets, part.lattice.size()), {}, weights, context);

  constexpr std::uint32_t fixed = ~0U;
  std::vector<std::uint32_t> unknown(part.lattice.size(), fixed), vertex;
  std::vector<double> known(kBlock * part.lattice.size(), 0.0), pull(known.size());
  for (std::uint32_t v = 0; v < part.lattice.size(); ++v) {
    const std::uint32_t w = whole.at(cell_key(part.lattice[v]));
    if (is_new[w] != 0) {
      unknown[v] = static_cast<std::uint32_t>(vertex.size());
      vertex.push_back(w);
    } else {
      std::copy_n(surface.quadrics[w].begin(), kBlock, known.begin() + static_cast<std::ptrdiff_t>(kBlock * v));
    }
  }
  if (vertex.empty()) return;
  energy.matrix.multiply(known, pull);
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (std::uint32_t v = 0; v < part.lattice.size(); ++v)
    for (const std::uint32_t w : energy.matrix.columns(v))
      if (unknown[v] != fixed && unknown[w] != fixed) pairs.push_back({unknown[v], unknown[w]});
  BlockMatrix small(vertex.size(), std::move(pairs));
  std::vector<double> right(kBlock * vertex.size());
  for (std::uint32_t v = 0; v < part.lattice.size(); ++v) {
    if (unknown[v] == fixed) continue;
    const auto columns = energy.matrix.columns(v);
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (unknown[columns[n]] == fixed) continue;
      const double* block = energy.matrix.block(v, n);
      small.add(unknown[v], unknown[columns[n]], [&](std::size_t i, std::size_t j) { return block[10 * i + j]; });
    }
    for (std::size_t i = 0; i < kBlock; ++i) right[kBlock * unknown[v] + i] = -pull[kBlock * v + i];
  }
  solve_past_ridge(BlockCholesky(small, context), energy.ridge, right);
  for (std::size_t k = 0; k < vertex.size(); ++k)
    std::copy_n(right.begin() + static_cast<std::ptrdiff_t>(kBlock * k), kBlock, surface.quadrics[vertex[k]].begin());
}

}  // namespace

std::vector<std::uint32_t> open_faces(const TetraQuad& surface, const HalfFaces& faces) {
  std::vector<std::uint32_t> open;
  std::size_t made_for = surface.mesh.tets.size();
  TetCubic c{};
  for (const std::uint32_t f : faces.border()) {
    if (f / 4 != made_for) c = ordinates(surface, made_for = f / 4);
    if (crosses_face(c, f % 4)) open.push_back(f);
  }
  return open;
}

std::size_t grow_once(TetraQuad& surface, HalfFaces& faces, const std::vector<LatticePoint>& data, int reach,
                      const EnergyWeights& weights, const Context& context) {
  std::vector<TetPlace> places = surface.mesh.places;
  const std::size_t before = places.size();
  for (const std::uint32_t f : open_faces(surface, faces)) {
    const TetPlace beyond = across(surface.mesh.split, surface.mesh.places[f / 4], static_cast<int>(f % 4));
    if (is_near(beyond.cell, data, reach)) places.push_back(beyond);
  }
  if (places.size() == before) return 0;
  TetraQuad grown;
  grown.georef = surface.georef;
  grown.mesh = make_tet_mesh(surface.mesh.origin, surface.mesh.step, surface.mesh.split, std::move(places));
  std::unordered_map<std::uint64_t, std::uint32_t> old;
  for (std::uint32_t v = 0; v < surface.mesh.lattice.size(); ++v) old.emplace(cell_key(surface.mesh.lattice[v]), v);
  grown.quadrics.resize(grown.mesh.lattice.size());
  std::vector<char> is_new(grown.quadrics.size(), 0);
  for (std::size_t v = 0; v < grown.quadrics.size(); ++v) {
    const auto at = old.find(cell_key(grown.mesh.lattice[v]));
    if (at == old.end())
      is_new[v] = 1;
    else
      grown.quadrics[v] = surface.quadrics[at->second];
  }
  faces = HalfFaces(grown.mesh.tets, grown.mesh.lattice.size());
  solve_new(grown, faces, is_new, weights, context);
  surface = std::move(grown);
  return surface.mesh.tets.size() - before;
}

}  // namespace retalho
