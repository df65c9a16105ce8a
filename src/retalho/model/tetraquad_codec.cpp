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

constexpr std::array<const char*, 3> kCubeNames = {"cube_x", "cube_y", "cube_z"};

[[noreturn]] void refuse(const std::string& words, const char* where) {
  throw CannotRead("the model is damaged: " + words, {}, where);
}

void refuse_faults(const TetraQuad& surface) {
  if (const std::string fault = find_fault(surface); !fault.empty())
    throw BadInput("this TetraQuad cannot be saved: " + fault);
}

using QuadricTables = flatbuffers::Vector<flatbuffers::Offset<fb::Numbers>>;

flatbuffers::Offset<QuadricTables> encode_quadrics(flatbuffers::FlatBufferBuilder& builder,
                                                   const std::vector<Quadric>& quadrics) {
  std::vector<flatbuffers::Offset<fb::Numbers>> coefficients;
  for (std::size_t k = 0; k < 10; ++k) {
    std::vector<double> values;
    values.reserve(quadrics.size());
    for (const Quadric& q : quadrics) values.push_back(q[k]);
    coefficients.push_back(add_numbers(builder, pack_reals(values)));
  }
  return builder.CreateVector(coefficients);
}

/// `vertices`: as many as the tetrahedra have.
std::vector<Quadric> decode_quadrics(const QuadricTables* tables, std::size_t vertices) {
  if (tables == nullptr || tables->size() != 10) refuse("not ten coefficients a vertex", "quadrics");
  std::vector<Quadric> quadrics(vertices);
  for (std::uint32_t k = 0; k < 10; ++k) {
    const std::vector<double> values = unpack_reals(view(tables->Get(k), "quadrics"), vertices, "quadrics");
    for (std::size_t v = 0; v < values.size(); ++v) quadrics[v][k] = values[v];
  }
  return quadrics;
}

std::vector<std::uint8_t> decode_marks(const fb::Numbers* numbers, std::uint64_t count, const char* name) {
  std::vector<std::uint8_t> marks;
  const std::vector<std::int64_t> values = unpack_integers(view(numbers, name), count, name);
  marks.reserve(values.size());
  for (const std::int64_t value : values) {
    if (value != 0 && value != 1) refuse(fmt::format("{} holds {}, not 0 or 1", name, value), name);
    marks.push_back(static_cast<std::uint8_t>(value));
  }
  return marks;
}

TetForest decode_forest(const fb::AdaptiveTetraQuadSurface& table) {
  if (table.cubes() == 0 || table.cubes() >= (1U << 29)) refuse(fmt::format("{} root cubes", table.cubes()), "cubes");
  if (table.nodes() >= (1U << 30)) refuse(fmt::format("{} nodes", table.nodes()), "nodes");
  std::vector<LatticePoint> cubes;
  const std::array<const fb::Numbers*, 3> parts = {table.cube_x(), table.cube_y(), table.cube_z()};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<std::int64_t> values =
        unpack_integers(view(parts[k], kCubeNames[k]), table.cubes(), kCubeNames[k]);
    cubes.resize(values.size());
    for (std::size_t n = 0; n < values.size(); ++n) {
      if (values[n] <= -1000 || values[n] >= 1000)
        refuse(fmt::format("{} is {} in cube {}", kCubeNames[k], values[n], n), kCubeNames[k]);
      cubes[n][k] = static_cast<std::int32_t>(values[n]);
    }
  }
  const std::vector<std::uint8_t> halved = decode_marks(table.halved(), table.nodes(), "halved");
  try {
    return {std::move(cubes), halved};
  } catch (const BadInput& fault) {
    refuse(fault.what(), "halved");
  }
}

/// What the tables of grids and of adaptive meshes both have.
template <class Table>
void add_frame(Table& table, flatbuffers::Offset<fb::Georef> georef, const TetMesh& mesh) {
  table.add_georef(georef);
  table.add_origin_x(mesh.origin.x);
  table.add_origin_y(mesh.origin.y);
  table.add_origin_z(mesh.origin.z);
  table.add_step(mesh.step);
}

}  // namespace

flatbuffers::Offset<fb::TetraQuadSurface> encode_tetraquad(flatbuffers::FlatBufferBuilder& builder,
                                                           const TetraQuad& surface, bool checked) {
  if (checked) refuse_faults(surface);
  const TetMesh& mesh = surface.mesh;
  const auto georef = encode_georef(builder, surface.georef);
  std::array<flatbuffers::Offset<fb::Numbers>, 4> places;
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<std::int64_t> values;
    values.reserve(mesh.places.size());
    for (const TetPlace& place : mesh.places) values.push_back(k < 3 ? place.cell[k] : place.type);
    places[k] = add_numbers(builder, pack_integers(values));
  }
  const auto quadrics = encode_quadrics(builder, surface.quadrics);
  fb::TetraQuadSurfaceBuilder table(builder);
  add_frame(table, georef, mesh);
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
  surface.quadrics = decode_quadrics(table.quadrics(), surface.mesh.lattice.size());
  if (const std::string fault = find_fault(surface); !fault.empty()) refuse(fault, "surface");
  return surface;
}

flatbuffers::Offset<fb::AdaptiveTetraQuadSurface> encode_adaptive(flatbuffers::FlatBufferBuilder& builder,
                                                                  const TetraQuad& surface, bool checked) {
  if (checked) refuse_faults(surface);
  const TetMesh& mesh = surface.mesh;
  const auto georef = encode_georef(builder, surface.georef);
  const std::vector<LatticePoint> cubes = mesh.forest->cubes();
  std::array<flatbuffers::Offset<fb::Numbers>, 3> parts;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<std::int64_t> values;
    values.reserve(cubes.size());
    for (const LatticePoint& cube : cubes) values.push_back(cube[k]);
    parts[k] = add_numbers(builder, pack_integers(values));
  }
  const std::vector<std::uint8_t> marks = mesh.forest->halved();
  const auto halved = add_numbers(builder, pack_integers(std::vector<std::int64_t>(marks.begin(), marks.end())));
  std::vector<std::int64_t> belongs;
  belongs.reserve(marks.size());
  for (const std::uint32_t leaf : mesh.forest->leaves()) belongs.push_back(mesh.tet_of_leaf.contains(leaf) ? 1 : 0);
  const auto present = add_numbers(builder, pack_integers(belongs));
  const auto quadrics = encode_quadrics(builder, surface.quadrics);
  fb::AdaptiveTetraQuadSurfaceBuilder table(builder);
  add_frame(table, georef, mesh);
  table.add_cubes(cubes.size());
  table.add_nodes(marks.size());
  table.add_leaves(belongs.size());
  table.add_vertices(mesh.lattice.size());
  table.add_cube_x(parts[0]);
  table.add_cube_y(parts[1]);
  table.add_cube_z(parts[2]);
  table.add_halved(halved);
  table.add_present(present);
  table.add_quadrics(quadrics);
  return table.Finish();
}

TetraQuad decode_adaptive(const fb::AdaptiveTetraQuadSurface& table) {
  TetraQuad surface;
  surface.georef = decode_georef(*table.georef());
  const auto forest = std::make_shared<TetForest>(decode_forest(table));
  const std::vector<std::uint32_t> leaves = forest->leaves();
  if (leaves.size() != table.leaves())
    refuse(fmt::format("{} leaves, not {}", leaves.size(), table.leaves()), "leaves");
  const std::vector<std::uint8_t> present = decode_marks(table.present(), table.leaves(), "present");
  std::vector<std::uint32_t> kept;
  for (std::size_t n = 0; n < leaves.size(); ++n)
    if (present[n] != 0) kept.push_back(leaves[n]);
  surface.mesh = make_tet_mesh({table.origin_x(), table.origin_y(), table.origin_z()}, table.step(), forest, kept);
  if (surface.mesh.lattice.size() != table.vertices())
    refuse(fmt::format("{} vertices for tetrahedra with {}", table.vertices(), surface.mesh.lattice.size()),
           "vertices");
  surface.quadrics = decode_quadrics(table.quadrics(), surface.mesh.lattice.size());
  if (const std::string fault = find_fault(surface); !fault.empty()) refuse(fault, "surface");
  return surface;
}

}  // namespace retalho
