#include "retalho/tetraquad/growth.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

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

Vec3 middle_of(const TetMesh& mesh, const LatticePoint& cell) {
  return mesh.origin + mesh.step * Vec3{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
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

/// Some of a mesh's tetrahedra as a mesh; points are not located in it. `whole`: of each vertex, its number there.
TetMesh select(const TetMesh& mesh, const std::vector<std::uint32_t>& tets, std::vector<std::uint32_t>& whole) {
  TetMesh part;
  part.origin = mesh.origin;
  part.step = mesh.step;
  part.split = mesh.split;
  part.forest = mesh.forest;
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  for (const std::uint32_t t : tets) {
    TetCorners tet = mesh.tets[t];
    for (std::uint32_t& v : tet) {
      const auto [at, fresh] = number.try_emplace(v, static_cast<std::uint32_t>(whole.size()));
      if (fresh) {
        whole.push_back(v);
        part.lattice.push_back(mesh.lattice[v]);
      }
      v = at->second;
    }
    part.tets.push_back(tet);
  }
  return part;
}

}  // namespace

void solve_new(TetraQuad& surface, const HalfFaces& faces, const std::vector<char>& is_new,
               const EnergyWeights& weights, const Context& context) {
  const TetMesh& mesh = surface.mesh;
  std::vector<std::uint32_t> around, whole;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    if (std::none_of(mesh.tets[t].begin(), mesh.tets[t].end(), [&](std::uint32_t v) { return is_new[v] != 0; }))
      continue;
    around.push_back(t);
    for (std::size_t i = 0; i < 4; ++i)
      if (const std::int64_t o = faces.neighbour(t, i); o >= 0) around.push_back(static_cast<std::uint32_t>(o));
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  const TetMesh part = select(mesh, around, whole);
  const Energy energy = assemble_energy(part, HalfFaces(part.tets, part.lattice.size()), {}, weights, context);

  constexpr std::uint32_t fixed = ~0U;
  std::vector<std::uint32_t> unknown(part.lattice.size(), fixed), vertex;
  std::vector<double> known(kBlock * part.lattice.size(), 0.0), pull(known.size());
  for (std::uint32_t v = 0; v < part.lattice.size(); ++v) {
    const std::uint32_t w = whole[v];
    if (is_new[w] != 0) {
      unknown[v] = static_cast<std::uint32_t>(vertex.size());
      vertex.push_back(v);
    } else {
      for (std::size_t i = 0; i < kBlock; ++i) known[kBlock * v + i] = surface.quadrics[w][i] / unit_of(energy, v, i);
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
    for (std::size_t i = 0; i < kBlock; ++i)
      surface.quadrics[whole[vertex[k]]][i] = right[kBlock * k + i] * unit_of(energy, vertex[k], i);
}

TetraQuad moved_to(const TetraQuad& surface, TetMesh mesh, std::vector<char>* is_new) {
  TetraQuad other;
  other.georef = surface.georef;
  other.mesh = std::move(mesh);
  std::unordered_map<std::uint64_t, std::uint32_t> old;
  for (std::uint32_t v = 0; v < surface.mesh.lattice.size(); ++v) old.emplace(cell_key(surface.mesh.lattice[v]), v);
  other.quadrics.resize(other.mesh.lattice.size());
  if (is_new != nullptr) is_new->assign(other.quadrics.size(), 0);
  for (std::size_t v = 0; v < other.quadrics.size(); ++v) {
    const auto at = old.find(cell_key(other.mesh.lattice[v]));
    if (at != old.end())
      other.quadrics[v] = surface.quadrics[at->second];
    else if (is_new != nullptr)
      (*is_new)[v] = 1;
  }
  return other;
}

namespace {

/// The same surface on other tetrahedra of the grid; vertices that it did not have get zeros.
TetraQuad with_places(const TetraQuad& surface, std::vector<TetPlace> places) {
  return moved_to(surface, make_tet_mesh(surface.mesh.origin, surface.mesh.step, surface.mesh.split, std::move(places)),
                  nullptr);
}

/// `own`, and those of the others that the surface reaches from there without meeting an open face.
std::vector<TetPlace> useful_places(const TetraQuad& surface, const HalfFaces& faces,
                                    const std::vector<TetPlace>& own) {
  const TetMesh& mesh = surface.mesh;
  const auto is_own = [&](std::size_t t) { return std::binary_search(own.begin(), own.end(), mesh.places[t]); };
  enum : char { unseen, kept, open };
  std::vector<char> state(mesh.tets.size(), unseen);
  std::vector<std::uint32_t> stack;
  // Spreads a state over added tetrahedra, across faces that the surface crosses.
  const auto spread = [&](std::uint32_t from, char value, std::vector<std::uint32_t>* reached) {
    stack.assign(1, from);
    while (!stack.empty()) {
      const std::uint32_t t = stack.back();
      stack.pop_back();
      const TetCubic c = ordinates(surface, t);
      for (std::size_t i = 0; i < 4; ++i) {
        const std::int64_t o = faces.neighbour(t, i);
        if (o < 0 || !crosses_face(c, i)) continue;
        const auto other = static_cast<std::uint32_t>(o);
        if (is_own(other) || state[other] != unseen) continue;
        state[other] = value;
        if (reached != nullptr) reached->push_back(other);
        stack.push_back(other);
      }
    }
  };
  for (const std::uint32_t f : open_faces(surface, faces)) {
    if (is_own(f / 4) || state[f / 4] != unseen) continue;
    state[f / 4] = open;
    spread(f / 4, open, nullptr);
  }
  std::vector<TetPlace> places = own;
  std::vector<std::uint32_t> reached;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    if (is_own(t)) spread(t, kept, &reached);
  for (const std::uint32_t t : reached) places.push_back(mesh.places[t]);
  return places;
}

}  // namespace

std::vector<std::uint32_t> leaves_of(const TetMesh& mesh) {
  std::vector<std::uint32_t> leaves(mesh.tets.size());
  for (const auto& [leaf, tet] : mesh.tet_of_leaf) leaves[tet] = leaf;
  return leaves;
}

std::vector<char> hanging_together(const TetraQuadField& field, const HalfFaces& faces, std::vector<char> seeds) {
  std::vector<std::uint32_t> stack;
  for (std::uint32_t t = 0; t < seeds.size(); ++t)
    if (seeds[t] != 0) stack.push_back(t);
  while (!stack.empty()) {
    const std::uint32_t t = stack.back();
    stack.pop_back();
    for (std::size_t i = 0; i < 4; ++i) {
      const std::int64_t o = faces.neighbour(t, i);
      if (o < 0 || seeds[static_cast<std::size_t>(o)] != 0 || !crosses_face(field.ordinates(t), i)) continue;
      seeds[static_cast<std::size_t>(o)] = 1;
      stack.push_back(static_cast<std::uint32_t>(o));
    }
  }
  return seeds;
}

std::size_t drop_stray(TetraQuad& surface, HalfFaces& faces, const std::vector<TetPlace>& with_points) {
  const TetMesh& mesh = surface.mesh;
  const TetraQuadField field(surface);
  std::vector<char> seeds(mesh.tets.size(), 0);
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    seeds[t] = std::binary_search(with_points.begin(), with_points.end(), mesh.places[t]) ? 1 : 0;
  const std::vector<char> reached = hanging_together(field, faces, std::move(seeds));
  std::vector<TetPlace> places;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
    if (reached[t] != 0 || !field.may_cross(t)) places.push_back(mesh.places[t]);
  const std::size_t dropped = mesh.tets.size() - places.size();
  if (dropped > 0) {
    surface = with_places(surface, std::move(places));
    faces = HalfFaces(surface.mesh.tets, surface.mesh.lattice.size());
  }
  return dropped;
}

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

int grow(TetraQuad& surface, HalfFaces& faces, const std::vector<LatticePoint>& data, int reach, int rounds,
         const Fill& fill, const ClosedGuide* guide, const Context& context) {
  const std::vector<TetPlace> own = surface.mesh.places;
  std::unordered_set<std::uint64_t> own_vertices;
  for (const LatticePoint& v : surface.mesh.lattice) own_vertices.insert(cell_key(v));
  int round = 0;
  while (round < rounds) {
    context.check();
    std::vector<TetPlace> places = surface.mesh.places;
    std::unordered_set<std::uint64_t> seen;
    for (const std::uint32_t f : open_faces(surface, faces)) {
      const TetPlace beyond = across(surface.mesh.split, surface.mesh.places[f / 4], static_cast<int>(f % 4));
      for (int side = 0; side < 27; ++side) {
        const LatticePoint cell = {beyond.cell[0] + side % 3 - 1, beyond.cell[1] + side / 3 % 3 - 1,
                                   beyond.cell[2] + side / 9 - 1};
        if (!seen.insert(cell_key(cell)).second) continue;
        if (guide != nullptr ? !guide->holds(middle_of(surface.mesh, cell)) : !is_near(cell, data, reach)) continue;
        for (int type = 0; type < tets_of_cube(surface.mesh.split); ++type)
          places.push_back({cell, static_cast<std::uint8_t>(type)});
      }
    }
    const std::size_t before = surface.mesh.tets.size();
    TetraQuad grown = with_places(surface, std::move(places));
    if (grown.mesh.tets.size() == before) break;
    ++round;
    surface = std::move(grown);
    faces = HalfFaces(surface.mesh.tets, surface.mesh.lattice.size());
    std::vector<char> is_new(surface.quadrics.size());
    for (std::size_t v = 0; v < is_new.size(); ++v)
      is_new[v] = own_vertices.contains(cell_key(surface.mesh.lattice[v])) ? 0 : 1;
    fill(surface, faces, is_new);
  }
  if (round > 0) {
    surface = with_places(surface, useful_places(surface, faces, own));
    faces = HalfFaces(surface.mesh.tets, surface.mesh.lattice.size());
  }
  return round;
}

}  // namespace retalho
