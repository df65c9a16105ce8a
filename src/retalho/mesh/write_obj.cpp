// Wavefront OBJ: text that reads back to the same doubles; normals and texture share the vertices' numbers.
#include "retalho/mesh/formats.h"

namespace retalho {

void write_obj(const TriangleMesh& mesh, ByteSink& out) {
  const bool normals = !mesh.normals.empty(), texture = !mesh.texture.empty();
  const auto line = [&](std::string_view keyword, std::initializer_list<double> values) {
    out.text(keyword);
    for (const double v : values) out.text(" "), out.number(v);
    out.text("\n");
  };
  out.text("# retalho\n");
  for (const Vec3& local : mesh.positions) {
    const Vec3 p = local + mesh.offset;
    line("v", {p.x, p.y, p.z});
  }
  for (const Vec2& t : mesh.texture) line("vt", {t.x, t.y});
  for (const Vec3& n : mesh.normals) line("vn", {n.x, n.y, n.z});
  for (const auto& triangle : mesh.triangles) {
    out.text("f");
    for (const std::uint32_t k : triangle) {
      const std::uint64_t number = std::uint64_t{k} + 1;
      out.text(" "), out.number(number);
      if (texture) out.text("/"), out.number(number);
      if (normals) out.text(texture ? "/" : "//"), out.number(number);
    }
    out.text("\n");
  }
}

}  // namespace retalho
