// What the page saves: triangles or a model file, as bytes.
#pragma once

#include <string>

#include "calls.h"
#include "retalho/mesh/mesh.h"

namespace retalho::viewer {

inline constexpr std::size_t kMostSavedTriangles = 2'000'000;  ///< as OBJ some 250 MB

/// {"format": "obj" | "glb" | "retalho"}. Throws BadInput.
std::string save_format(const Json& input);

/// The bytes as the array "file".
Answer saved_model(const std::string& bytes);
/// The same of a mesh in the format, with the number of its triangles and vertices. Throws BadInput for more triangles
/// than kMostSavedTriangles.
Answer saved_mesh(const TriangleMesh& mesh, const std::string& format);

}  // namespace retalho::viewer
