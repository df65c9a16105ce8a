// STL, binary: single precision only, so positions stay local and the header tells what to add to them.
#include <fmt/format.h>

#include <limits>

#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"

namespace retalho {

void write_stl(const MeshStream& mesh, ByteSink& out) {
  if (mesh.triangles > std::numeric_limits<std::uint32_t>::max())
    throw CannotWrite("an STL file holds at most 4,294,967,295 triangles");
  // It must not begin with "solid", which marks the ASCII form.
  std::string header = fmt::format("retalho, offset {} {} {}", mesh.offset.x, mesh.offset.y, mesh.offset.z);
  header.resize(80, ' ');
  out.text(header);
  out.binary(static_cast<std::uint32_t>(mesh.triangles));
  const auto put = [&](Vec3 p) {
    for (const double v : {p.x, p.y, p.z}) out.binary(static_cast<float>(v));
  };
  mesh.each_triangle([&](TriangleBlock block) {
    for (const auto& v : block) {
      const Vec3 a = mesh.position(v[0]), b = mesh.position(v[1]), c = mesh.position(v[2]);
      const Vec3 normal = cross(b - a, c - a);
      const double length = norm(normal);
      put(length > 0 ? normal / length : Vec3{0, 0, 0});
      put(a), put(b), put(c);
      out.binary(std::uint16_t{0});
    }
  });
}

}  // namespace retalho
