#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"

namespace retalho {
namespace {

using Writer = void (*)(const MeshStream&, ByteSink&);
struct Format {
  const char* extension;
  Writer write;
};
constexpr Format kFormats[] = {{".ply", write_ply}, {".obj", write_obj},     {".stl", write_stl},
                               {".glb", write_glb}, {".xml", write_landxml}, {".landxml", write_landxml}};

std::string extension(const std::string& path) {
  std::string e = std::filesystem::path(path).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

const Format* find_format(const std::string& path) {
  const std::string e = extension(path);
  const Format* const found =
      std::find_if(std::begin(kFormats), std::end(kFormats), [&](const Format& f) { return e == f.extension; });
  return found == std::end(kFormats) ? nullptr : found;
}

const Format& format_of(const std::string& path) {
  if (const Format* const format = find_format(path)) return *format;
  throw UsageError(
      fmt::format(
          "'{}' does not end in .ply, .obj, .stl, .glb, .xml or .landxml: the name tells the format of the mesh", path),
      path);
}

void check_arrays(const TriangleMesh& mesh, const std::string& path) {
  const std::size_t n = mesh.positions.size();
  if (!mesh.normals.empty() && mesh.normals.size() != n)
    throw BadInput(fmt::format("the mesh has {} normals for {} vertices", mesh.normals.size(), n), path);
  if (!mesh.texture.empty() && mesh.texture.size() != n)
    throw BadInput(fmt::format("the mesh has {} texture coordinates for {} vertices", mesh.texture.size(), n), path);
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(mesh.positions[i].x + mesh.positions[i].y + mesh.positions[i].z))
      throw BadInput(fmt::format("vertex {} is not finite", i), path);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= n) throw BadInput(fmt::format("triangle {} names vertex {} of {}", t, v, n), path);
}

}  // namespace

bool is_mesh_name(const std::string& path) {
  return find_format(path) != nullptr;
}

void widen(Vec3& low, Vec3& high, Vec3 point) {
  low = {std::min(low.x, point.x), std::min(low.y, point.y), std::min(low.z, point.z)};
  high = {std::max(high.x, point.x), std::max(high.y, point.y), std::max(high.z, point.z)};
}

MeshStream stream_of(const TriangleMesh& mesh) {
  MeshStream stream;
  stream.vertices = mesh.positions.size();
  stream.triangles = mesh.triangles.size();
  stream.normals = !mesh.normals.empty();
  stream.texture = !mesh.texture.empty();
  if (!mesh.positions.empty()) stream.low = stream.high = mesh.positions.front();
  for (const Vec3& p : mesh.positions) widen(stream.low, stream.high, p);
  stream.offset = mesh.offset;
  stream.unit = mesh.unit;
  stream.crs_wkt = mesh.crs_wkt;
  stream.each_vertex = [&mesh](const auto& take) { take({mesh.positions, mesh.normals, mesh.texture}); };
  stream.each_triangle = [&mesh](const auto& take) { take(mesh.triangles); };
  stream.position = [&mesh](std::uint32_t v) { return mesh.positions[v]; };
  return stream;
}

void write_stream(const std::string& path, bool overwrite,
                  const std::function<MeshStream(const std::string& temporary)>& fill) {
  const Format& format = format_of(path);
  AtomicFile file(path, overwrite);
  const MeshStream mesh = fill(file.temporary());
  ByteSink out(file.temporary(), path);
  format.write(mesh, out);
  out.close();
  file.commit();
}

void write_mesh(const TriangleMesh& mesh, const std::string& path, bool overwrite) {
  format_of(path);  // a name without a format is said before anything else
  check_arrays(mesh, path);
  write_stream(path, overwrite, [&](const std::string&) { return stream_of(mesh); });
}

std::string encode_mesh(const TriangleMesh& mesh, const std::string& extension) {
  const std::string name = "mesh" + extension;
  const Format& format = format_of(name);
  check_arrays(mesh, name);
  std::string bytes;
  ByteSink out(bytes);
  format.write(stream_of(mesh), out);
  out.close();
  return bytes;
}

TriangleMesh read_mesh(const std::string& path) {
  const std::string e = extension(path);
  if (e != ".ply" && e != ".obj")
    throw CannotRead(fmt::format("cannot read '{}' as a mesh: .ply and .obj are read", path), path);
  const std::string bytes = read_file(path);
  return e == ".ply" ? read_ply(bytes, path) : read_obj(bytes, path);
}

}  // namespace retalho
