// Meshes as OBJ.
#include "retalho/mesh/formats.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] {
    const TriangleMesh mesh = read_obj(fuzz::text_of(data, size), "fuzz.obj");
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) fuzz::require(v < mesh.positions.size(), "a corner that is not there");
  });
}
