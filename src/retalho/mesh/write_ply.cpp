// PLY, binary little-endian (Turk 1994): double positions in the CRS, float normals and texture.
#include "retalho/mesh/formats.h"

namespace retalho {

void write_ply(const MeshStream& mesh, ByteSink& out) {
  out.text("ply\nformat binary_little_endian 1.0\ncomment retalho\nelement vertex ");
  out.number(mesh.vertices);
  out.text("\nproperty double x\nproperty double y\nproperty double z\n");
  if (mesh.normals) out.text("property float nx\nproperty float ny\nproperty float nz\n");
  if (mesh.texture) out.text("property float s\nproperty float t\n");
  out.text("element face ");
  out.number(mesh.triangles);
  out.text("\nproperty list uchar uint vertex_indices\nend_header\n");
  mesh.each_vertex([&](const VertexBlock& block) {
    for (std::size_t i = 0; i < block.positions.size(); ++i) {
      const Vec3 p = block.positions[i] + mesh.offset;
      out.binary(p.x), out.binary(p.y), out.binary(p.z);
      if (mesh.normals)
        for (const double v : {block.normals[i].x, block.normals[i].y, block.normals[i].z})
          out.binary(static_cast<float>(v));
      if (mesh.texture)
        for (const double v : {block.texture[i].x, block.texture[i].y}) out.binary(static_cast<float>(v));
    }
  });
  mesh.each_triangle([&](TriangleBlock block) {
    for (const auto& v : block) {
      out.binary(std::uint8_t{3});
      for (const std::uint32_t k : v) out.binary(k);
    }
  });
}

}  // namespace retalho
