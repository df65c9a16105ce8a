#include "retalho/mesh/patch_mesh.h"

#include <bit>
#include <map>
#include <tuple>

namespace retalho {
namespace {

using Key = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>;
Key key_of(Vec3 p) {
  return {std::bit_cast<std::uint64_t>(p.x + 0.0), std::bit_cast<std::uint64_t>(p.y + 0.0),
          std::bit_cast<std::uint64_t>(p.z + 0.0)};  // + 0.0: one zero
}

}  // namespace

TriangleMesh mesh_patches(std::span<const Patch> patches, bool weld) {
  TriangleMesh mesh;
  std::map<Key, std::uint32_t> shared;
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
    for (const auto& t : patch.domain.triangles) mesh.triangles.push_back({name[t[0]], name[t[1]], name[t[2]]});
  }
  mesh.normals.assign(mesh.positions.size(), Vec3{});
  for (const auto& t : mesh.triangles) {
    const Vec3 n = cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (const std::uint32_t i : t) mesh.normals[i] = mesh.normals[i] + n;
  }
  for (Vec3& n : mesh.normals) n = norm(n) > 0 ? normalized(n) : Vec3{0, 0, 1};
  return mesh;
}

}  // namespace retalho
