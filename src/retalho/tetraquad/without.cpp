#include "retalho/tetraquad/without.h"

#include "retalho/tetraquad/fit_parts.h"
#include "retalho/tetraquad/growth.h"

namespace retalho {

TetraQuad without_tetrahedra(const TetraQuad& surface, const std::vector<char>& left_out, TetraQuadFitReport* report) {
  const TetMesh& mesh = surface.mesh;
  TetMesh rest;
  if (mesh.forest) {
    const std::vector<std::uint32_t> all = leaves_of(mesh);
    std::vector<std::uint32_t> leaves;
    for (std::size_t t = 0; t < all.size(); ++t)
      if (left_out[t] == 0) leaves.push_back(all[t]);
    rest = make_tet_mesh(mesh.origin, mesh.step, mesh.forest, leaves);
  } else {
    std::vector<TetPlace> places;
    for (std::size_t t = 0; t < mesh.places.size(); ++t)
      if (left_out[t] == 0) places.push_back(mesh.places[t]);
    rest = make_tet_mesh(mesh.origin, mesh.step, mesh.split, std::move(places));
  }
  TetraQuad kept = moved_to(surface, std::move(rest), nullptr);
  if (report != nullptr) count_sizes(TetraQuadField(kept), *report);
  return kept;
}

}  // namespace retalho
