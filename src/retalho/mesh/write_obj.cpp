// Wavefront OBJ: text that reads back to the same doubles; normals and texture share the vertices' numbers.
#include "retalho/mesh/formats.h"

namespace retalho {

void write_obj(const MeshStream& mesh, ByteSink& out) {
  const auto line = [&](std::string_view keyword, std::initializer_list<double> values) {
    out.text(keyword);
    for (const double v : values) out.text(" "), out.number(v);
    out.text("\n");
  };
  out.text("# retalho\n");
  mesh.each_vertex([&](const VertexBlock& block) {
    for (const Vec3& local : block.positions) {
      const Vec3 p = local + mesh.offset;
      line("v", {p.x, p.y, p.z});
    }
  });
  if (mesh.texture)
    mesh.each_vertex([&](const VertexBlock& block) {
      for (const Vec2& t : block.texture) line("vt", {t.x, t.y});
    });
  if (mesh.normals)
    mesh.each_vertex([&](const VertexBlock& block) {
      for (const Vec3& n : block.normals) line("vn", {n.x, n.y, n.z});
    });
  mesh.each_triangle([&](TriangleBlock block) {
    for (const auto& triangle : block) {
      out.text("f");
      for (const std::uint32_t k : triangle) {
        const std::uint64_t number = std::uint64_t{k} + 1;
        out.text(" "), out.number(number);
        if (mesh.texture) out.text("/"), out.number(number);
        if (mesh.normals) out.text(mesh.texture ? "/" : "//"), out.number(number);
      }
      out.text("\n");
    }
  });
}

}  // namespace retalho
