// PLY, binary little-endian (Turk 1994): double positions in the CRS, float normals and texture.
#include "retalho/mesh/formats.h"

namespace retalho {

void write_ply(const TriangleMesh& mesh, ByteSink& out) {
  const bool normals = !mesh.normals.empty(), texture = !mesh.texture.empty();
  out.text("ply\nformat binary_little_endian 1.0\ncomment retalho\nelement vertex ");
  out.number(std::uint64_t{mesh.positions.size()});
  out.text("\nproperty double x\nproperty double y\nproperty double z\n");
  if (normals) out.text("property float nx\nproperty float ny\nproperty float nz\n");
  if (texture) out.text("property float s\nproperty float t\n");
  out.text("element face ");
  out.number(std::uint64_t{mesh.triangles.size()});
  out.text("\nproperty list uchar uint vertex_indices\nend_header\n");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 p = mesh.positions[i] + mesh.offset;
    out.binary(p.x), out.binary(p.y), out.binary(p.z);
    if (normals)
      for (const double v : {mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z})
        out.binary(static_cast<float>(v));
    if (texture)
      for (const double v : {mesh.texture[i].x, mesh.texture[i].y}) out.binary(static_cast<float>(v));
  }
  for (const auto& v : mesh.triangles) {
    out.binary(std::uint8_t{3});
    for (const std::uint32_t k : v) out.binary(k);
  }
}

}  // namespace retalho
