#include "retalho/tetraquad/tet_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

using CubeCorners = std::array<std::uint8_t, 4>;  // bit 0: x, bit 1: y, bit 2: z

constexpr std::array<CubeCorners, 5> kEven = {{{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}}};
constexpr std::array<CubeCorners, 5> kOdd = {{{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 1, 2, 7}, {5, 1, 4, 7}, {6, 2, 4, 7}}};
constexpr std::array<CubeCorners, 6> kKuhn = {
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

const CubeCorners& cube_corners(TetSplit split, const TetPlace& place) {
  if (split == TetSplit::kuhn) return kKuhn[place.type];
  return ((place.cell[0] + place.cell[1] + place.cell[2]) & 1) != 0 ? kOdd[place.type] : kEven[place.type];
}

LatticePoint cube_corner(const LatticePoint& cell, int corner) {
  return {cell[0] + (corner & 1), cell[1] + ((corner >> 1) & 1), cell[2] + ((corner >> 2) & 1)};
}

Vec3 to_vec(const LatticePoint& l) {
  return {static_cast<double>(l[0]), static_cast<double>(l[1]), static_cast<double>(l[2])};
}

TetFrame frame_of(const std::array<LatticePoint, 4>& c) {
  return {to_vec(c[0]), to_vec(c[1]), to_vec(c[2]), to_vec(c[3])};
}

}  // namespace

std::array<LatticePoint, 4> lattice_corners(TetSplit split, const TetPlace& place) {
  const CubeCorners& corners = cube_corners(split, place);
  return {cube_corner(place.cell, corners[0]), cube_corner(place.cell, corners[1]), cube_corner(place.cell, corners[2]),
          cube_corner(place.cell, corners[3])};
}

TetPlace across(TetSplit split, const TetPlace& place, int corner) {
  const auto own = lattice_corners(split, place);
  const auto shares_face = [&](const TetPlace& other) {
    const auto corners = lattice_corners(split, other);
    for (int i = 0; i < 4; ++i)
      if (i != corner && std::find(corners.begin(), corners.end(), own[static_cast<std::size_t>(i)]) == corners.end())
        return false;
    return true;
  };
  for (int side = 0; side < 7; ++side) {  // the cube itself, then its six neighbours
    TetPlace other = place;
    if (side > 0) other.cell[static_cast<std::size_t>((side - 1) / 2)] += (side % 2) != 0 ? 1 : -1;
    for (int type = 0; type < tets_of_cube(split); ++type) {
      other.type = static_cast<std::uint8_t>(type);
      if (other != place && shares_face(other)) return other;
    }
  }
  throw std::logic_error("a face of the full grid without another side");
}

TetPlace place_of(TetSplit split, Vec3 p) {
  TetPlace best;
  best.cell = {static_cast<std::int32_t>(std::floor(p.x)), static_cast<std::int32_t>(std::floor(p.y)),
               static_cast<std::int32_t>(std::floor(p.z))};
  TetPlace tried = best;
  double depth = -1e300;
  for (int type = 0; type < tets_of_cube(split); ++type) {
    tried.type = static_cast<std::uint8_t>(type);
    const TetBarycentric b = frame_of(lattice_corners(split, tried)).barycentric(p);
    const double least = *std::min_element(b.begin(), b.end());
    if (least > depth) {
      depth = least;
      best.type = tried.type;
    }
  }
  return best;
}

std::uint64_t cell_key(const LatticePoint& cell) {
  const auto part = [](std::int32_t c) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(c + (1 << 20)));
  };
  return part(cell[0]) | part(cell[1]) << 21 | part(cell[2]) << 42;
}

TetMesh make_tet_mesh(Vec3 origin, double step, TetSplit split, std::vector<TetPlace> places) {
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  TetMesh mesh;
  mesh.origin = origin;
  mesh.step = step;
  mesh.split = split;
  mesh.tets.reserve(places.size());
  std::unordered_map<std::uint64_t, std::uint32_t> number;
  for (const TetPlace& place : places) {
    for (const std::int32_t c : place.cell)
      if (std::abs(c) >= (1 << 20) - 2) throw BadInput("a tetrahedral grid of more than 2^20 cubes along a side");
    mesh.first_in_cell.try_emplace(cell_key(place.cell), static_cast<std::uint32_t>(mesh.tets.size()));
    TetCorners tet{};
    const auto corners = lattice_corners(split, place);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [at, fresh] =
          number.try_emplace(cell_key(corners[i]), static_cast<std::uint32_t>(mesh.lattice.size()));
      if (fresh) mesh.lattice.push_back(corners[i]);
      tet[i] = at->second;
    }
    mesh.tets.push_back(tet);
  }
  mesh.places = std::move(places);
  return mesh;
}

TetMesh make_tet_mesh(Vec3 origin, double step, std::shared_ptr<const TetForest> forest,
                      const std::vector<std::uint32_t>& leaves) {
  TetMesh mesh;
  mesh.origin = origin;
  mesh.step = step;
  mesh.split = TetSplit::kuhn;
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  for (const std::uint32_t leaf : leaves) {
    TetCorners tet = forest->nodes()[leaf].corners;
    for (std::uint32_t& v : tet) {
      const auto [at, fresh] = number.try_emplace(v, static_cast<std::uint32_t>(mesh.lattice.size()));
      if (fresh) mesh.lattice.push_back(forest->vertices()[v]);
      v = at->second;
    }
    mesh.tet_of_leaf.emplace(leaf, static_cast<std::uint32_t>(mesh.tets.size()));
    mesh.tets.push_back(tet);
  }
  mesh.forest = std::move(forest);
  return mesh;
}

TetFrame TetMesh::frame(std::size_t tet) const {
  const TetCorners& c = tets[tet];
  return frame_of({lattice[c[0]], lattice[c[1]], lattice[c[2]], lattice[c[3]]});
}

std::int64_t TetMesh::locate(Vec3 p, TetBarycentric* where) const {
  const Vec3 u = to_lattice(p);
  if (forest) {
    const std::int64_t leaf = forest->locate(u, where);
    if (leaf < 0) return -1;
    const auto at = tet_of_leaf.find(static_cast<std::uint32_t>(leaf));
    return at == tet_of_leaf.end() ? -1 : static_cast<std::int64_t>(at->second);
  }
  constexpr double reach = (1 << 20) - 2;
  if (!(std::abs(u.x) < reach && std::abs(u.y) < reach && std::abs(u.z) < reach)) return -1;
  const LatticePoint cell = {static_cast<std::int32_t>(std::floor(u.x)), static_cast<std::int32_t>(std::floor(u.y)),
                             static_cast<std::int32_t>(std::floor(u.z))};
  const auto first = first_in_cell.find(cell_key(cell));
  if (first == first_in_cell.end()) return -1;
  std::int64_t best = -1;
  double depth = -1e-9;  // rounding's share: a point on a face belongs to somebody
  for (std::size_t t = first->second; t < places.size() && places[t].cell == cell; ++t) {
    const TetBarycentric b = frame(t).barycentric(u);
    const double least = *std::min_element(b.begin(), b.end());
    if (least > depth) {
      depth = least;
      best = static_cast<std::int64_t>(t);
      if (where != nullptr) *where = b;
    }
  }
  return best;
}

void write_vtk(const TetMesh& mesh, const std::vector<double>& data, const std::string& path, bool overwrite) {
  if (!data.empty() && data.size() != mesh.lattice.size()) throw UsageError("write_vtk: one number a vertex, or none");
  std::string text = "# vtk DataFile Version 3.0\nRetalho tetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "POINTS {} double\n", mesh.lattice.size());
  for (std::size_t v = 0; v < mesh.lattice.size(); ++v) {
    const Vec3 p = mesh.position(v);
    fmt::format_to(out, "{} {} {}\n", p.x, p.y, p.z);
  }
  fmt::format_to(out, "CELLS {} {}\n", mesh.tets.size(), 5 * mesh.tets.size());
  for (const TetCorners& t : mesh.tets) fmt::format_to(out, "4 {} {} {} {}\n", t[0], t[1], t[2], t[3]);
  fmt::format_to(out, "CELL_TYPES {}\n", mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) text += "10\n";
  if (!data.empty()) {
    fmt::format_to(out, "POINT_DATA {}\nSCALARS data double 1\nLOOKUP_TABLE default\n", data.size());
    for (const double d : data) fmt::format_to(out, "{}\n", d);
  }
  write_file(path, text, overwrite);
}

}  // namespace retalho
