#include "saved_file.h"

#include <fmt/format.h>

#include "retalho/core/error.h"

namespace retalho::viewer {

std::string save_format(const Json& input) {
  return word(input, "format", {"obj", "glb", "retalho"});
}

Answer saved_model(const std::string& bytes) {
  return {{{"bytes", bytes.size()}}, {{"file", "u8", bytes}}};
}

Answer saved_mesh(const TriangleMesh& mesh, const std::string& format) {
  if (mesh.triangles.size() > kMostSavedTriangles)
    throw BadInput(
        fmt::format("{} triangles are more than the page saves ({}): save the model, and make the mesh with "
                    "`retalho mesh`",
                    mesh.triangles.size(), kMostSavedTriangles));
  const std::string bytes = encode_mesh(mesh, "." + format);
  return {{{"triangles", mesh.triangles.size()}, {"vertices", mesh.positions.size()}, {"bytes", bytes.size()}},
          {{"file", "u8", bytes}}};
}

}  // namespace retalho::viewer
