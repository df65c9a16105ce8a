#include "retalho/mesh/patch_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <set>
#include <tuple>

#include "retalho/patch/joins.h"

namespace retalho {
namespace {

using Key = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>;
Key key_of(Vec3 p) {
  return {std::bit_cast<std::uint64_t>(p.x + 0.0), std::bit_cast<std::uint64_t>(p.y + 0.0),
          std::bit_cast<std::uint64_t>(p.z + 0.0)};  // + 0.0: one zero
}

/// Two patches that share both sides at a corner have the same triangle there, and welded it would be one with two
/// faces. The second one's is joined with its neighbour and cut the other way. `corners` are those of the patches so
/// far.
void part_corners(TriangleMesh& mesh, std::size_t begin, const Patch& patch,
                  std::set<std::array<std::uint32_t, 3>>& corners) {
  const auto& own = patch.domain.triangles;
  for (std::size_t t = 0; t < own.size(); ++t)
    for (const auto& side : patch.domain.sides) {
      const auto at = std::find(own[t].begin(), own[t].end(), side[0]);
      if (at == own[t].end()) continue;
      auto key = mesh.triangles[begin + t];
      const auto k = static_cast<std::size_t>(at - own[t].begin());
      const std::uint32_t p = key[k], a = key[(k + 1) % 3], b = key[(k + 2) % 3];
      std::sort(key.begin(), key.end());
      if (corners.insert(key).second) continue;
      for (std::size_t other = begin; other < mesh.triangles.size(); ++other) {
        auto& n = mesh.triangles[other];
        for (std::size_t j = 0; j < 3; ++j) {
          if (n[j] != b || n[(j + 1) % 3] != a) continue;
          const std::uint32_t c = n[(j + 2) % 3];
          n = {p, c, b};
          mesh.triangles[begin + t] = {p, a, c};
          other = mesh.triangles.size() - 1;  // found: leave both loops
          break;
        }
      }
    }
}

}  // namespace

TriangleMesh mesh_patches(std::span<const Patch> patches, bool weld) {
  TriangleMesh mesh;
  std::map<Key, std::uint32_t> shared;
  std::set<std::array<std::uint32_t, 3>> corners;
  for (const Patch& patch : patches) {
    std::vector<std::uint32_t> name(patch.positions.size(), 0xffffffffU);
    const auto add = [&](std::uint32_t i) {
      mesh.positions.push_back(patch.positions[i]);
      mesh.texture.push_back(patch.domain.parameters[i]);
      return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    };
    if (weld && patches.size() > 1)
      for (const auto& side : patch.domain.sides)
        for (const std::uint32_t i : side) {
          if (name[i] != 0xffffffffU) continue;
          const auto [at, fresh] = shared.try_emplace(key_of(patch.positions[i]), 0);
          if (fresh) at->second = add(i);
          name[i] = at->second;
        }
    for (std::uint32_t i = 0; i < name.size(); ++i)
      if (name[i] == 0xffffffffU) name[i] = add(i);
    const std::size_t begin = mesh.triangles.size();
    for (const auto& t : patch.domain.triangles) mesh.triangles.push_back({name[t[0]], name[t[1]], name[t[2]]});
    if (weld && patches.size() > 1) part_corners(mesh, begin, patch, corners);
  }
  mesh.normals.assign(mesh.positions.size(), Vec3{});
  for (const auto& t : mesh.triangles) {
    const Vec3 n = cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (const std::uint32_t i : t) mesh.normals[i] = mesh.normals[i] + n;
  }
  for (Vec3& n : mesh.normals) n = norm(n) > 0 ? normalized(n) : Vec3{0, 0, 1};
  return mesh;
}

TriangleMesh mesh_patch_surfaces(std::span<const Patch> patches, std::span<const PatchSurface> surfaces,
                                 double tolerance, double* deviation, std::size_t* factor, const Context& context) {
  std::vector<Patch> fine;
  for (std::size_t n = 1;; n *= 2) {
    fine.clear();
    double worst = 0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      fine.push_back(refine(patches[i], surfaces[i], n));
      const Domain& domain = fine[i].domain;
      std::size_t looked = 0;
      for (const auto& t : domain.triangles) {
        if (++looked % 256 == 0) context.check();  // a recovered point may cost tens of microseconds
        for (const auto& [a, b, c] :
             {std::array<double, 3>{1.0 / 3, 1.0 / 3, 1.0 / 3}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}}) {
          const Vec2 uv = a * domain.parameters[t[0]] + b * domain.parameters[t[1]] + c * domain.parameters[t[2]];
          const Vec3 flat = a * fine[i].positions[t[0]] + b * fine[i].positions[t[1]] + c * fine[i].positions[t[2]];
          worst = std::max(worst, norm(surfaces[i].point(uv) - flat));
        }
      }
    }
    if (worst > tolerance && tolerance > 0 && n < 64) continue;
    if (deviation) *deviation = worst;
    if (factor) *factor = n;
    return mesh_patches(fine);
  }
}

}  // namespace retalho
