// glTF 2.0 as one binary file (Khronos, glTF 2.0 specification, section 4). Positions are single precision about the
// centre of the box, so that no digits are lost; glTF's axes are x, y up, -z: the root node turns ours (z up) into
// them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"

namespace retalho {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint32_t kGlb = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr int kFloat = 5126, kUnsigned = 5125, kArrayBuffer = 34962, kElementBuffer = 34963;

std::array<float, 3> single(Vec3 p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// The document, and the length of the binary part that it describes.
struct Plan {
  Json document;
  std::uint64_t bytes = 0;

  void add(std::uint64_t size, int target, Json accessor) {
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes}, {"byteLength", size}, {"target", target}});
    accessor["bufferView"] = document["bufferViews"].size() - 1;
    document["accessors"].push_back(std::move(accessor));
    bytes += size;
  }
};

Plan describe(const MeshStream& mesh, Vec3 centre) {
  Plan plan;
  Json& d = plan.document;
  const std::uint64_t n = mesh.vertices;
  d["asset"] = {{"version", "2.0"}, {"generator", "retalho"}};
  d["scene"] = 0;
  d["scenes"] = Json::array({{{"nodes", {0}}}});
  const double half = 0.70710678118654757;
  d["nodes"] = Json::array({{{"name", "z-up to y-up"},
                             {"rotation", {-half, 0.0, 0.0, half}},
                             {"children", {1}},
                             {"extras", {{"offset", {mesh.offset.x, mesh.offset.y, mesh.offset.z}}}}},
                            {{"name", "surface"}, {"mesh", 0}, {"translation", {centre.x, centre.y, centre.z}}}});
  d["bufferViews"] = Json::array();
  d["accessors"] = Json::array();
  Json attributes = {{"POSITION", 0}};
  plan.add(n * 12, kArrayBuffer,
           {{"componentType", kFloat},
            {"count", n},
            {"type", "VEC3"},
            {"min", single(mesh.low - centre)},
            {"max", single(mesh.high - centre)}});
  if (mesh.normals) {
    attributes["NORMAL"] = d["accessors"].size();
    plan.add(n * 12, kArrayBuffer, {{"componentType", kFloat}, {"count", n}, {"type", "VEC3"}});
  }
  if (mesh.texture) {
    attributes["TEXCOORD_0"] = d["accessors"].size();
    plan.add(n * 8, kArrayBuffer, {{"componentType", kFloat}, {"count", n}, {"type", "VEC2"}});
  }
  const std::size_t indices = d["accessors"].size();
  plan.add(mesh.triangles * 12, kElementBuffer,
           {{"componentType", kUnsigned}, {"count", mesh.triangles * 3}, {"type", "SCALAR"}});
  d["materials"] = Json::array(
      {{{"name", "surface"},
        {"doubleSided", true},
        {"pbrMetallicRoughness",
         {{"baseColorFactor", {0.75, 0.72, 0.66, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.9}}}}});
  d["meshes"] = Json::array(
      {{{"primitives",
         Json::array({{{"attributes", attributes}, {"indices", indices}, {"material", 0}, {"mode", 4}}})}}});
  d["buffers"] = Json::array({{{"byteLength", plan.bytes}}});
  return plan;
}

}  // namespace

void write_glb(const MeshStream& mesh, ByteSink& out) {
  if (mesh.triangles == 0) throw CannotWrite("a glTF file cannot hold a mesh without triangles");
  const Vec3 centre = 0.5 * (mesh.low + mesh.high);
  const Plan plan = describe(mesh, centre);
  std::string text = plan.document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t total = 12 + 8 + text.size() + 8 + plan.bytes;  // every part of the buffer is a multiple of 4
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw CannotWrite(fmt::format(
        "a glTF file holds at most 4 GB and this mesh needs {} bytes: use a larger tolerance, or .ply", total));
  for (const std::uint32_t word :
       {kGlb, 2U, static_cast<std::uint32_t>(total), static_cast<std::uint32_t>(text.size()), kJsonChunk})
    out.binary(word);
  out.text(text);
  out.binary(static_cast<std::uint32_t>(plan.bytes));
  out.binary(kBinaryChunk);
  const auto put = [&](std::array<float, 3> v) {
    for (const float x : v) out.binary(x);
  };
  mesh.each_vertex([&](const VertexBlock& block) {
    for (const Vec3& p : block.positions) put(single(p - centre));
  });
  if (mesh.normals)
    mesh.each_vertex([&](const VertexBlock& block) {
      for (const Vec3& n : block.normals) put(single(n));
    });
  if (mesh.texture)
    mesh.each_vertex([&](const VertexBlock& block) {
      for (const Vec2& t : block.texture) {
        // glTF's texture origin is the upper left corner, ours the lower left.
        out.binary(static_cast<float>(t.x));
        out.binary(static_cast<float>(1 - t.y));
      }
    });
  mesh.each_triangle([&](TriangleBlock block) {
    for (const auto& v : block)
      for (const std::uint32_t k : v) out.binary(k);
  });
}

}  // namespace retalho
