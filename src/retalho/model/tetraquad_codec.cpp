#include "retalho/model/tetraquad_codec.h"

#include <fmt/format.h>

#include <array>

#include "retalho/core/error.h"
#include "retalho/model/check.h"
#include "retalho/model/codec_parts.h"

namespace retalho {
namespace {

namespace fb = model_file;

constexpr std::array<const char*, 4> kPlaceNames = {"cell_x", "cell_y", "cell_z", "tet_type"};

}  // namespace

flatbuffers::Offset<fb::TetraQuadSurface> encode_tetraquad(flatbuffers::FlatBufferBuilder& builder,
                                                           const TetraQuad& surface, bool checked) {
  if (checked) {
    if (const std::string fault = find_fault(surface); !fault.empty())
      throw BadInput("this TetraQuad cannot be saved: " + fault);
  }
  const TetMesh& mesh = surface.mesh;
  const auto georef = encode_georef(builder, surface.georef);
  std::array<flatbuffers::Offset<fb::Numbers>, 4> places;
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<std::int64_t> values;
    values.reserve(mesh.places.size());
    for (const TetPlace& place : mesh.places) values.push_back(k < 3 ? place.cell[k] : place.type);
    places[k] = add_numbers(builder, pack_integers(values));
  }
  std::vector<flatbuffers::Offset<fb::Numbers>> coefficients;
  for (std::size_t k = 0; k < 10; ++k) {
    std::vector<double> values;
    values.reserve(surface.quadrics.size());
    for (const Quadric& q : surface.quadrics) values.push_back(q[k]);
    coefficients.push_back(add_numbers(builder, pack_reals(values)));
  }
  const auto quadrics = builder.CreateVector(coefficients);
  fb::TetraQuadSurfaceBuilder table(builder);
  table.add_georef(georef);
  table.add_origin_x(mesh.origin.x);
  table.add_origin_y(mesh.origin.y);
  table.add_origin_z(mesh.origin.z);
  table.add_step(mesh.step);
  table.add_split(static_cast<fb::TetSplit>(mesh.split));
  table.add_tetrahedra(mesh.tets.size());
  table.add_vertices(mesh.lattice.size());
  table.add_cell_x(places[0]);
  table.add_cell_y(places[1]);
  table.add_cell_z(places[2]);
  table.add_tet_type(places[3]);
  table.add_quadrics(quadrics);
  return table.Finish();
}

TetraQuad decode_tetraquad(const fb::TetraQuadSurface& table) {
  const auto refuse = [](const std::string& words, const char* where) -> void {
    throw CannotRead("the model is damaged: " + words, {}, where);
  };
  TetraQuad surface;
  surface.georef = decode_georef(*table.georef());
  if (table.tetrahedra() >= (std::uint64_t{1} << 29) || table.tetrahedra() == 0)
    refuse(fmt::format("{} tetrahedra", table.tetrahedra()), "tetrahedra");
  if (table.split() > fb::TetSplit::MAX) refuse("an unknown way to cut cubes", "split");
  const auto split = static_cast<TetSplit>(table.split());
  std::vector<TetPlace> places;
  const std::array<const fb::Numbers*, 4> parts = {table.cell_x(), table.cell_y(), table.cell_z(), table.tet_type()};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::vector<std::int64_t> values =
        unpack_integers(view(parts[k], kPlaceNames[k]), table.tetrahedra(), kPlaceNames[k]);
    places.resize(values.size());
    const std::int64_t reach = k < 3 ? (1 << 20) - 3 : tets_of_cube(split) - 1, least = k < 3 ? -reach : 0;
    for (std::size_t t = 0; t < values.size(); ++t) {
      if (values[t] < least || values[t] > reach)
        refuse(fmt::format("{} is {} in tetrahedron {}", kPlaceNames[k], values[t], t), kPlaceNames[k]);
      if (k < 3)
        places[t].cell[k] = static_cast<std::int32_t>(values[t]);
      else
        places[t].type = static_cast<std::uint8_t>(values[t]);
    }
  }
  for (std::size_t t = 1; t < places.size(); ++t)
    if (!(places[t - 1] < places[t])) refuse(fmt::format("tetrahedron {} is out of order", t), "cell_x");
  surface.mesh =
      make_tet_mesh({table.origin_x(), table.origin_y(), table.origin_z()}, table.step(), split, std::move(places));
  if (surface.mesh.lattice.size() != table.vertices())
    refuse(fmt::format("{} vertices for tetrahedra with {}", table.vertices(), surface.mesh.lattice.size()),
           "vertices");
  if (table.quadrics() == nullptr || table.quadrics()->size() != 10)
    refuse("not ten coefficients a vertex", "quadrics");
  surface.quadrics.resize(surface.mesh.lattice.size());
  for (std::uint32_t k = 0; k < 10; ++k) {
    const std::vector<double> values =
        unpack_reals(view(table.quadrics()->Get(k), "quadrics"), table.vertices(), "quadrics");
    for (std::size_t v = 0; v < values.size(); ++v) surface.quadrics[v][k] = values[v];
  }
  if (const std::string fault = find_fault(surface); !fault.empty()) refuse(fault, "surface");
  return surface;
}

}  // namespace retalho
