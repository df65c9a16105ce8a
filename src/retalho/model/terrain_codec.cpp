#include "retalho/model/terrain_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/model/check.h"
#include "retalho/model/codec_parts.h"
#include "retalho/model/numbers.h"
#include "retalho/model/split_prediction.h"
#include "retalho/terrain/creases.h"

namespace retalho {
namespace {

namespace fb = model_file;
using Builder = flatbuffers::FlatBufferBuilder;
bool same_bits(Vec2 a, Vec2 b) {
  return std::bit_cast<std::uint64_t>(a.x) == std::bit_cast<std::uint64_t>(b.x) &&
         std::bit_cast<std::uint64_t>(a.y) == std::bit_cast<std::uint64_t>(b.y);
}

// --- positions -------------------------------------------------------------------------------------------------------

/// The centre of a cell, as Raster::centre; the sign of row 0's zero is kept apart.
Vec2 cell_centre(const GridDomain& grid, std::int64_t cell, bool minus_zero_north) {
  const std::int64_t row = cell / grid.columns, column = cell % grid.columns;
  const double y = row == 0 ? (minus_zero_north ? -0.0 : 0.0) : -static_cast<double>(row) * grid.cell_height;
  return {static_cast<double>(column) * grid.cell_width, y};
}

/// The cells that the vertices are, if each is a cell's centre to the bit.
std::optional<std::vector<std::int64_t>> as_cells(const Terrain& terrain, bool minus_zero_north) {
  const GridDomain& grid = terrain.grid;
  if (grid.columns == 0) return std::nullopt;
  std::vector<std::int64_t> cells;
  cells.reserve(terrain.tin.points.size());
  for (const Vec2 p : terrain.tin.points) {
    const double column = std::nearbyint(p.x / grid.cell_width), row = std::nearbyint(-p.y / grid.cell_height);
    if (!(column >= 0 && column < grid.columns && row >= 0 && row < grid.rows)) return std::nullopt;
    const std::int64_t cell = static_cast<std::int64_t>(row) * grid.columns + static_cast<std::int64_t>(column);
    if (!same_bits(cell_centre(grid, cell, minus_zero_north), p)) return std::nullopt;
    cells.push_back(cell);
  }
  return cells;
}

struct PointParts {
  flatbuffers::Offset<fb::Numbers> cells, x, y;
  bool minus_zero_north = false;
};

template <typename Get>
PackedNumbers pack_component(const std::vector<Vec2>& values, Get get) {
  std::vector<double> component(values.size());
  std::transform(values.begin(), values.end(), component.begin(), get);
  return pack_reals(component);
}
double get_x(Vec2 v) {
  return v.x;
}
double get_y(Vec2 v) {
  return v.y;
}

PointParts encode_points(Builder& builder, const Terrain& terrain) {
  PointParts parts;
  for (const bool minus_zero_north : {true, false})
    if (const auto cells = as_cells(terrain, minus_zero_north)) {
      parts.cells = add_numbers(builder, pack_integers(*cells));
      parts.minus_zero_north = minus_zero_north;
      return parts;
    }
  parts.x = add_numbers(builder, pack_component(terrain.tin.points, get_x));
  parts.y = add_numbers(builder, pack_component(terrain.tin.points, get_y));
  return parts;
}

std::vector<Vec2> unpack_pairs(const fb::Numbers* x, const fb::Numbers* y, std::uint64_t count, const char* what_x,
                               const char* what_y) {
  const std::vector<double> xs = unpack_reals(view(x, what_x), count, what_x),
                            ys = unpack_reals(view(y, what_y), count, what_y);
  std::vector<Vec2> pairs(xs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {xs[i], ys[i]};
  return pairs;
}

std::vector<Vec2> decode_points(const fb::TerrainSurface& table, const GridDomain& grid) {
  if (!table.cells()) return unpack_pairs(table.x(), table.y(), table.vertices(), "x", "y");
  const std::int64_t end = std::int64_t{grid.columns} * grid.rows;
  std::vector<Vec2> points;
  const std::vector<std::int64_t> cells = unpack_integers(view(table.cells(), "cells"), table.vertices(), "cells");
  points.reserve(cells.size());
  for (const std::int64_t cell : cells) {
    if (cell < 0 || cell >= end)
      throw CannotRead(fmt::format("a vertex lies in cell {} of {}", cell, end), {}, "cells");
    points.push_back(cell_centre(grid, cell, table.minus_zero_north()));
  }
  return points;
}

// --- triangles -------------------------------------------------------------------------------------------------------

using TriangleParts = std::array<flatbuffers::Offset<fb::Numbers>, 3>;

TriangleParts encode_triangles(Builder& builder, const Tin& tin) {
  TriangleParts parts;
  std::vector<std::int64_t> values(tin.triangles.size());
  for (std::size_t k = 0; k < 3; ++k) {
    std::transform(tin.triangles.begin(), tin.triangles.end(), values.begin(), [k](const auto& v) {
      return k == 0 ? std::int64_t{v[0]} : std::int64_t{v[k]} - std::int64_t{v[0]};
    });
    parts[k] = add_numbers(builder, pack_integers(values));
  }
  return parts;
}

std::vector<std::array<std::uint32_t, 3>> decode_triangles(const fb::TerrainSurface& table) {
  constexpr std::array<const char*, 3> kNames = {"corner_a", "corner_b", "corner_c"};
  const std::array<const fb::Numbers*, 3> parts = {table.corner_a(), table.corner_b(), table.corner_c()};
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<std::int64_t> values = unpack_integers(view(parts[k], kNames[k]), table.triangles(), kNames[k]);
    triangles.resize(values.size());
    for (std::size_t t = 0; t < values.size(); ++t) {
      const std::uint64_t index = static_cast<std::uint64_t>(values[t]) + (k == 0 ? 0 : triangles[t][0]);
      if (index >= table.vertices())
        throw CannotRead(
            fmt::format("triangle {} names vertex {} of {}", t, static_cast<std::int64_t>(index), table.vertices()), {},
            kNames[k]);
      triangles[t][k] = static_cast<std::uint32_t>(index);
    }
  }
  return triangles;
}

// --- grid and position -----------------------------------------------------------------------------------------------

std::size_t mask_stride(int columns) {
  return (static_cast<std::size_t>(columns) + 63) / 64;
}

flatbuffers::Offset<fb::Grid> encode_grid(Builder& builder, const GridDomain& grid) {
  flatbuffers::Offset<fb::Mask> mask;
  if (!grid.valid.empty()) {
    if (grid.valid == Mask(grid.columns, grid.rows, true)) {
      mask = fb::CreateMask(builder, fb::MaskForm::every_cell);
    } else {
      const std::vector<std::uint64_t>& words = grid.valid.words();
      const std::size_t stride = mask_stride(grid.columns);
      std::string bytes(words.size() * 8, '\0');
      for (std::size_t i = 0; i < words.size(); ++i) {
        const std::uint64_t word = words[i] ^ (i < stride ? 0 : words[i - stride]);
        for (std::size_t k = 0; k < 8; ++k) bytes[8 * i + k] = static_cast<char>((word >> (8 * k)) & 0xff);
      }
      const auto frame = add_bytes(builder, compress(bytes));
      mask = fb::CreateMask(builder, fb::MaskForm::bits, frame);
    }
  }
  return fb::CreateGrid(builder, grid.columns, grid.rows, grid.cell_width, grid.cell_height, mask);
}

Mask decode_mask(const fb::Mask& table, int columns, int rows) {
  constexpr const char* kWhat = "mask";
  if (columns <= 0 || rows <= 0)
    throw CannotRead(fmt::format("a mask on a grid of {} x {} cells", columns, rows), {}, kWhat);
  const std::size_t stride = mask_stride(columns), words = stride * static_cast<std::size_t>(rows);
  if (table.form() == fb::MaskForm::every_cell) {
    // Nothing in the file vouches for the size, so it is held to the largest grid there is: 65,535 cells a side.
    if (std::uint64_t{words} > (std::uint64_t{1} << 26))
      throw CannotRead(fmt::format("a mask of {} x {} cells", columns, rows), {}, kWhat);
    return Mask(columns, rows, true);
  }
  if (table.form() != fb::MaskForm::bits || !table.zstd())
    throw CannotRead("the mask is stored in a form that this Retalho does not know", {}, kWhat);
  const std::string bytes = decompress(view(*table.zstd()), words * 8, kWhat);
  Mask mask(columns, rows, false);
  for (std::size_t i = 0; i < words; ++i) {
    std::uint64_t word = i < stride ? 0 : mask.words()[i - stride];
    for (std::size_t k = 0; k < 8; ++k) word ^= std::uint64_t{static_cast<unsigned char>(bytes[8 * i + k])} << (8 * k);
    mask.words()[i] = word;
  }
  return mask;
}

GridDomain decode_grid(const fb::Grid& table) {
  GridDomain grid;
  grid.columns = table.columns();
  grid.rows = table.rows();
  grid.cell_width = table.cell_width();
  grid.cell_height = table.cell_height();
  if (table.mask()) grid.valid = decode_mask(*table.mask(), grid.columns, grid.rows);
  return grid;
}

// --- edges -----------------------------------------------------------------------------------------------------------

/// From the predicted split to the true one, in steps of one representable double.
std::vector<std::int64_t> split_steps(const Terrain& terrain) {
  const std::vector<double> predicted = predict_splits(terrain.tin, build_edges(terrain.tin));
  std::vector<std::int64_t> steps(predicted.size());
  for (std::size_t e = 0; e < steps.size(); ++e)
    steps[e] = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(terrain.edge_split[e]) -
                                         std::bit_cast<std::uint64_t>(predicted[e]));
  return steps;
}

std::vector<double> decode_splits(const fb::Numbers* numbers, const Tin& tin) {
  std::vector<double> splits = predict_splits(tin, build_edges(tin));
  const std::vector<std::int64_t> steps = unpack_integers(view(numbers, "edge_split"), splits.size(), "edge_split");
  for (std::size_t e = 0; e < steps.size(); ++e)
    splits[e] = std::bit_cast<double>(std::bit_cast<std::uint64_t>(splits[e]) + static_cast<std::uint64_t>(steps[e]));
  return splits;
}

std::vector<std::uint8_t> decode_flags(const fb::Numbers* numbers, std::uint64_t count) {
  const std::vector<std::int64_t> values = unpack_integers(view(numbers, "edge_fallback"), count, "edge_fallback");
  std::vector<std::uint8_t> flags(values.size());
  std::transform(values.begin(), values.end(), flags.begin(), [](std::int64_t v) {
    return static_cast<std::uint8_t>(v == 0 ? 0 : v == 1 ? 1 : 2);
  });
  return flags;
}

/// Sets the creases and which gradient each corner has; returns how many gradients there are.
std::size_t decode_creases(const fb::Numbers& numbers, Terrain& terrain) {
  const std::uint64_t count = numbers.count();
  const EdgeTable edges = build_edges(terrain.tin);
  if (count > edges.vertices.size())
    throw CannotRead(fmt::format("{} creases of {} edges", count, edges.vertices.size()), {}, "creases");
  for (const std::int64_t e : unpack_integers(view(&numbers, "creases"), count, "creases")) {
    if (e < 0 || e >= static_cast<std::int64_t>(edges.vertices.size()))
      throw CannotRead(fmt::format("crease {} is none of the {} edges", e, edges.vertices.size()), {}, "creases");
    terrain.creases.push_back(static_cast<std::uint32_t>(e));
  }
  std::size_t nodes = 0;
  terrain.corner_gradients = crease_sectors(terrain.tin, edges, terrain.creases, &nodes);
  return nodes;
}

}  // namespace

flatbuffers::Offset<fb::TerrainSurface> encode_terrain(Builder& builder, const Terrain& terrain, bool checked) {
  if (checked) {
    if (const std::string fault = find_fault(terrain); !fault.empty())
      throw BadInput("this terrain cannot be saved: " + fault);
  }
  const auto georef = encode_georef(builder, terrain.georef);
  const auto grid = encode_grid(builder, terrain.grid);
  const PointParts points = encode_points(builder, terrain);
  const auto heights = add_numbers(builder, pack_reals(terrain.tin.heights));
  const TriangleParts corners = encode_triangles(builder, terrain.tin);
  flatbuffers::Offset<fb::Numbers> gradient_x, gradient_y, edge_split, edge_fallback, creases;
  if (!terrain.gradients.empty()) {
    gradient_x = add_numbers(builder, pack_component(terrain.gradients, get_x));
    gradient_y = add_numbers(builder, pack_component(terrain.gradients, get_y));
  }
  if (!terrain.edge_split.empty()) edge_split = add_numbers(builder, pack_integers(split_steps(terrain)));
  if (!terrain.edge_fallback.empty())
    edge_fallback = add_numbers(
        builder, pack_integers(std::vector<std::int64_t>(terrain.edge_fallback.begin(), terrain.edge_fallback.end())));

  if (!terrain.creases.empty())
    creases =
        add_numbers(builder, pack_integers(std::vector<std::int64_t>(terrain.creases.begin(), terrain.creases.end())));

  fb::TerrainSurfaceBuilder table(builder);
  table.add_kind(static_cast<fb::TerrainKind>(terrain.kind));
  table.add_cross_derivative(static_cast<fb::CrossDerivative>(terrain.cross_derivative));
  table.add_gradient_kind(static_cast<fb::GradientKind>(terrain.gradient_kind));
  table.add_tolerance(terrain.tolerance);
  table.add_georef(georef);
  table.add_grid(grid);
  table.add_vertices(terrain.tin.vertex_count());
  table.add_triangles(terrain.tin.triangle_count());
  if (!points.cells.IsNull()) table.add_cells(points.cells);
  table.add_minus_zero_north(points.minus_zero_north);
  if (!points.x.IsNull()) table.add_x(points.x);
  if (!points.y.IsNull()) table.add_y(points.y);
  table.add_heights(heights);
  table.add_corner_a(corners[0]);
  table.add_corner_b(corners[1]);
  table.add_corner_c(corners[2]);
  if (!gradient_x.IsNull()) table.add_gradient_x(gradient_x);
  if (!gradient_y.IsNull()) table.add_gradient_y(gradient_y);
  if (!edge_split.IsNull()) table.add_edge_split(edge_split);
  if (!edge_fallback.IsNull()) table.add_edge_fallback(edge_fallback);
  if (!creases.IsNull()) table.add_creases(creases);
  return table.Finish();
}

Terrain decode_terrain(const fb::TerrainSurface& table) {
  Terrain terrain;
  terrain.kind = static_cast<SurfaceKind>(table.kind());
  terrain.cross_derivative = static_cast<CrossDerivative>(table.cross_derivative());
  terrain.gradient_kind = static_cast<GradientKind>(table.gradient_kind());
  terrain.tolerance = table.tolerance();
  terrain.georef = decode_georef(*table.georef());
  terrain.grid = decode_grid(*table.grid());
  if (table.vertices() >= kNone || table.triangles() >= kNone / 3)
    throw CannotRead(fmt::format("{} vertices and {} triangles are more than 32 bits can number", table.vertices(),
                                 table.triangles()),
                     {}, "vertices");
  terrain.tin.points = decode_points(table, terrain.grid);
  terrain.tin.heights = unpack_reals(view(table.heights(), "heights"), table.vertices(), "heights");
  terrain.tin.triangles = decode_triangles(table);
  try {
    build_neighbors(terrain.tin);
    const std::size_t nodes = table.creases() ? decode_creases(*table.creases(), terrain) : table.vertices();
    if (table.gradient_x() || table.gradient_y())
      terrain.gradients = unpack_pairs(table.gradient_x(), table.gradient_y(), nodes, "gradient_x", "gradient_y");
    if (table.edge_split()) terrain.edge_split = decode_splits(table.edge_split(), terrain.tin);
    if (table.edge_fallback()) terrain.edge_fallback = decode_flags(table.edge_fallback(), edge_count(terrain.tin));
    if (const std::string fault = find_fault(terrain, true); !fault.empty())
      throw CannotRead("no terrain: " + fault, {}, "surface");
  } catch (const BadInput& e) {
    throw CannotRead(std::string("no terrain: ") + e.what(), {}, "triangles");
  }
  return terrain;
}

}  // namespace retalho
