#include "retalho/model/compact_file.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/model/byte_stream.h"
#include "retalho/model/check.h"
#include "retalho/model/compact_cells.h"
#include "retalho/model/numbers.h"
#include "retalho/raster/crs_code.h"
#include "retalho/terrain/folded_surface.h"

namespace retalho {
namespace {

using greedy::Cell;

constexpr std::string_view kSignature("\x89RTC", 4);
constexpr std::size_t kHashAt = 5, kContentAt = 9;
constexpr std::uint64_t kMostCells = std::uint64_t{1} << 28, kVerticesAByte = 256, kFreeVertices = 4096;
constexpr std::uint64_t kLongestWkt = std::uint64_t{1} << 20;

std::uint32_t checksum(std::string_view bytes) {
  XXH64_state_t state;
  XXH64_reset(&state, 0);
  XXH64_update(&state, bytes.data(), kHashAt);
  XXH64_update(&state, bytes.data() + kContentAt, bytes.size() - kContentAt);
  return static_cast<std::uint32_t>(XXH64_digest(&state));
}

/// The version of files whose vertices are folded, or not.
int version_for(bool folds) {
  return folds ? 2 : 1;
}

std::string seal_compact(std::string_view content, int version) {
  std::string out(kSignature);
  out.push_back(static_cast<char>(version));
  out.append(4, '\0');
  ByteWriter size;
  size.varint(content.size());
  out += size.bytes();
  out.append(content);
  const std::uint32_t sum = checksum(out);
  for (std::size_t k = 0; k < 4; ++k) out[kHashAt + k] = static_cast<char>(sum >> (8 * k) & 0xffU);
  return out;
}

std::string_view unseal_compact(std::string_view bytes) {
  if (bytes.size() <= kContentAt)
    throw CannotRead(fmt::format("the file ends after {} bytes, within its header", bytes.size()), {}, "header");
  if (const int version = static_cast<unsigned char>(bytes[4]); version > kCompactVersion)
    throw CannotRead(
        fmt::format("written by a newer Retalho (compact form {}; this one reads up to {}), or damaged: update Retalho",
                    version, kCompactVersion),
        {}, "format");
  ByteReader reader(bytes.substr(kContentAt));
  const std::uint64_t size = reader.varint("size");
  if (size > reader.rest().size())
    throw CannotRead(fmt::format("the file holds {} of {} bytes: it was cut short", reader.rest().size(), size), {},
                     "size");
  if (size < reader.rest().size())
    throw CannotRead(fmt::format("the file holds {} bytes and should hold {}", reader.rest().size(), size), {}, "size");
  std::uint32_t stored = 0;
  for (std::size_t k = 0; k < 4; ++k)
    stored |= std::uint32_t{static_cast<unsigned char>(bytes[kHashAt + k])} << (8 * k);
  if (stored != checksum(bytes)) throw CannotRead("damaged: the checksum does not fit the content", {}, "checksum");
  if (bytes[4] == 0) throw CannotRead("there is no compact form 0", {}, "format");
  return reader.rest();
}

// --- header ----------------------------------------------------------------------------------------------------------

constexpr unsigned kSurface = 3, kHeightsOnly = 4, kGeographic = 8, kMasked = 16, kFolded = 32;  // of the kind's byte
enum class CrsForm : std::uint8_t { none = 0, epsg = 1, wkt = 2 };

void write_crs(ByteWriter& out, const std::string& wkt) {
  const int code = epsg_of(wkt);
  out.byte(static_cast<std::uint8_t>(wkt.empty() ? CrsForm::none : code != 0 ? CrsForm::epsg : CrsForm::wkt));
  if (code != 0) {
    out.varint(static_cast<std::uint64_t>(code));
  } else if (!wkt.empty()) {
    out.varint(wkt.size());
    out.text(compress(wkt));
  }
}

std::string read_crs(ByteReader& in) {
  constexpr const char* kWhat = "CRS";
  switch (static_cast<CrsForm>(in.byte(kWhat))) {
    case CrsForm::none:
      return {};
    case CrsForm::epsg: {
      const std::uint64_t code = in.varint(kWhat);
      try {
        return wkt_of_epsg(static_cast<int>(std::min<std::uint64_t>(code, 1U << 30)));
      } catch (const BadInput& e) {
        throw CannotRead(e.what(), {}, kWhat);
      }
    }
    case CrsForm::wkt: {
      const std::uint64_t size = in.varint(kWhat);
      if (size > kLongestWkt) throw CannotRead(fmt::format("a CRS of {} bytes", size), {}, kWhat);
      return decompress(in.text(kWhat), size, kWhat);
    }
  }
  throw CannotRead("the CRS is stored in a form that this Retalho does not know", {}, kWhat);
}

void write_header(ByteWriter& out, const CompactFrameFacts& f, std::size_t vertices, bool folds) {
  out.byte(static_cast<std::uint8_t>(static_cast<unsigned>(f.kind) | (f.heights_only ? kHeightsOnly : 0U) |
                                     (f.georef.geographic ? kGeographic : 0U) | (f.grid.valid.empty() ? 0U : kMasked) |
                                     (folds ? kFolded : 0U)));
  out.varint(static_cast<std::uint64_t>(f.grid.columns));
  out.varint(static_cast<std::uint64_t>(f.grid.rows));
  out.varint(vertices);
  for (const double value : {f.grid.cell_width, f.grid.cell_height, f.georef.origin_x, f.georef.origin_y,
                             f.georef.scale_x, f.georef.scale_y, f.tolerance, f.reference, f.steps.height})
    out.real(value);
  out.byte(f.steps.crowding);
  out.byte(f.steps.slope);
  out.text(f.georef.unit);
  write_crs(out, f.georef.crs_wkt);
}

CompactFrameFacts read_header(ByteReader& in, std::uint64_t& vertices, bool& folds) {
  CompactFrameFacts f;
  const std::uint8_t kind = in.byte("kind");
  f.kind = static_cast<SurfaceKind>(kind & kSurface);
  f.heights_only = (kind & kHeightsOnly) != 0;
  f.georef.geographic = (kind & kGeographic) != 0;
  folds = (kind & kFolded) != 0;
  if (kind >= 64 || (f.kind != SurfaceKind::linear && f.kind != SurfaceKind::clough_tocher) ||
      ((f.heights_only || folds) && f.kind == SurfaceKind::linear) || (f.heights_only && folds))
    throw CannotRead(
        fmt::format("it holds a kind of surface ({}) that this Retalho does not know: update Retalho", kind), {},
        "surface");
  const std::uint64_t columns = in.varint("columns"), rows = in.varint("rows");
  vertices = in.varint("vertices");
  if (columns < 2 || rows < 2 || columns > 65535 || rows > 65535 || columns * rows > kMostCells)
    throw CannotRead(fmt::format("a grid of {} x {} cells", columns, rows), {}, "columns");
  if (vertices < 3 || vertices > columns * rows || vertices > kVerticesAByte * in.rest().size() + kFreeVertices)
    throw CannotRead(fmt::format("{} vertices in {} bytes", vertices, in.rest().size()), {}, "vertices");
  f.grid.columns = static_cast<int>(columns);
  f.grid.rows = static_cast<int>(rows);
  f.grid.cell_width = in.real("cell width");
  f.grid.cell_height = in.real("cell height");
  f.georef.origin_x = in.real("origin");
  f.georef.origin_y = in.real("origin");
  f.georef.scale_x = in.real("scale");
  f.georef.scale_y = in.real("scale");
  f.tolerance = in.real("tolerance");
  f.reference = in.real("reference");
  f.steps.height = in.real("height step");
  f.steps.crowding = in.byte("crowding");
  f.steps.slope = in.byte("slope step");
  f.georef.unit = in.text("unit");
  f.georef.crs_wkt = read_crs(in);
  if ((kind & kMasked) != 0) f.grid.valid = Mask(f.grid.columns, f.grid.rows, false);
  return f;
}

/// What is wrong with the header, in words; empty: nothing.
std::string fault_of(const CompactFrameFacts& f) {
  if (f.kind != SurfaceKind::linear && f.kind != SurfaceKind::clough_tocher)
    return "the compact form holds linear and Clough-Tocher surfaces";
  if (f.grid.columns < 2 || f.grid.rows < 2 || f.grid.columns > 65535 || f.grid.rows > 65535 ||
      static_cast<std::uint64_t>(f.grid.columns) * static_cast<std::uint64_t>(f.grid.rows) > kMostCells)
    return fmt::format("a grid of {} x {} cells: the compact form holds up to 65,535 a side and {} in all",
                       f.grid.columns, f.grid.rows, kMostCells);
  const auto sound = [](double v) { return std::isfinite(v) && v > 1e-100 && v < 1e100; };
  if (!sound(f.steps.height)) return fmt::format("a height step of {}", f.steps.height);
  if (f.steps.crowding > 32 || (f.kind == SurfaceKind::clough_tocher && !f.heights_only && f.steps.slope == 0))
    return "steps that are out of range";
  if (!sound(f.grid.cell_width) || !sound(f.grid.cell_height)) return "a cell without a size";
  const double ratio = f.grid.cell_width / f.grid.cell_height;
  if (!(ratio > 1e-6 && ratio < 1e6)) return "a cell that is a line";
  return {};
}

// --- the terrain -----------------------------------------------------------------------------------------------------

struct Payload {
  std::vector<Cell> cells;
  std::vector<std::uint8_t> folded;  ///< empty: none
  Mask mask;
  std::vector<CellLevel> levels;
  std::vector<VertexJet> values;
};

Vec2 lattice_step(const GridDomain& grid) {
  const double unit = std::sqrt(grid.cell_width * grid.cell_height);
  return {grid.cell_width / unit, grid.cell_height / unit};
}

/// Everything behind the header, written or read.
Payload code_payload(BitCoder& coder, const CompactFrameFacts& f, std::size_t vertices, const std::vector<Cell>& cells,
                     bool folds, const std::vector<std::uint8_t>& folded, ValueSource* source, const Context& context) {
  Payload p;
  if (!f.grid.valid.empty()) p.mask = code_mask(coder, f.grid.columns, f.grid.rows, f.grid.valid);
  p.cells = code_vertices(coder, f.grid.columns, f.grid.rows, vertices, cells);
  p.levels = make_levels(p.cells, context);
  if (folds) p.folded = code_folds(coder, p.levels.back(), folded);
  const CompactFrame frame{p.cells, p.levels, p.folded, lattice_step(f.grid), f.reference};
  const bool gradients = f.kind == SurfaceKind::clough_tocher && !f.heights_only;
  p.values = code_values(coder, frame, f.steps, gradients, source, context);
  return p;
}

Terrain assemble(const CompactFrameFacts& f, Payload& p) {
  Terrain terrain;
  terrain.kind = f.kind;
  terrain.georef = f.georef;
  terrain.grid = f.grid;
  terrain.grid.valid = std::move(p.mask);
  terrain.tolerance = f.tolerance;
  const double unit = std::sqrt(f.grid.cell_width * f.grid.cell_height);
  const CellLevel& finest = p.levels.back();
  if (f.heights_only) {
    std::vector<Vec2> points;
    std::vector<VertexJet> data;
    const Vec2 step = lattice_step(f.grid);
    for (const std::uint32_t v : finest.vertex) {
      points.push_back({greedy::column_of(p.cells[v]) * step.x, -greedy::row_of(p.cells[v]) * step.y});
      data.push_back(p.values[v]);
    }
    facet_gradients(points, finest.mesh.triangles(), {}, data);
    for (std::size_t k = 0; k < data.size(); ++k) p.values[finest.vertex[k]] = data[k];
  }
  for (std::size_t v = 0; v < p.cells.size(); ++v) {
    terrain.tin.points.push_back({static_cast<double>(greedy::column_of(p.cells[v])) * f.grid.cell_width,
                                  -static_cast<double>(greedy::row_of(p.cells[v])) * f.grid.cell_height});
    terrain.tin.heights.push_back(p.values[v][0]);
    if (f.kind == SurfaceKind::clough_tocher)
      terrain.gradients.push_back({p.values[v][1] / unit, p.values[v][2] / unit});
  }
  if (f.kind == SurfaceKind::clough_tocher)
    terrain.gradient_kind = f.heights_only ? GradientKind::normals : GradientKind::fitted;
  for (const auto& t : finest.mesh.triangles()) {
    std::array<std::uint32_t, 3> mapped{finest.vertex[t[0]], finest.vertex[t[1]], finest.vertex[t[2]]};
    std::rotate(mapped.begin(), std::min_element(mapped.begin(), mapped.end()), mapped.end());
    terrain.tin.triangles.push_back(mapped);
  }
  std::sort(terrain.tin.triangles.begin(), terrain.tin.triangles.end());
  build_neighbors(terrain.tin);
  if (std::find(p.folded.begin(), p.folded.end(), 1) != p.folded.end()) {
    FoldedSurface surface = folded_surface(terrain.tin, p.folded, terrain.gradients);
    terrain.creases = std::move(surface.creases);
    terrain.gradients = std::move(surface.gradients);
    if (!terrain.creases.empty()) terrain.corner_gradients = std::move(surface.sectors);
  }
  return terrain;
}

}  // namespace

bool has_compact_signature(std::string_view bytes) {
  return bytes.starts_with(kSignature);
}

CompactEncoding encode_compact(const CompactFrameFacts& facts, const std::vector<Cell>& cells, ValueSource& source,
                               const Context& context, const std::vector<std::uint8_t>& folded) {
  if (const std::string fault = fault_of(facts); !fault.empty())
    throw BadInput("this terrain has no compact form: " + fault);
  ByteWriter header;
  bool folds = std::find(folded.begin(), folded.end(), 1) != folded.end();
  write_header(header, facts, cells.size(), folds);
  const std::string padded = header.bytes() + std::string(cells.size() / kVerticesAByte, '\0');
  ByteReader again(padded);
  std::uint64_t vertices = 0;
  CompactFrameFacts read = read_header(again, vertices, folds);  // what the reader will know: -0 is 0
  read.grid.valid = facts.grid.valid;
  BitCoder coder;
  Payload payload = code_payload(coder, read, cells.size(), cells, folds, folded, &source, context);
  CompactEncoding result;
  std::string content = header.bytes() + coder.finish();
  const std::uint64_t least = cells.size() > kFreeVertices ? (cells.size() - kFreeVertices) / kVerticesAByte + 1 : 0;
  if (content.size() - header.bytes().size() < least) content.resize(header.bytes().size() + least, '\0');
  result.bytes = seal_compact(content, version_for(folds));
  result.terrain = assemble(read, payload);
  if (const std::string fault = find_fault(result.terrain, true); !fault.empty())
    throw BadInput("this terrain has no compact form: " + fault);
  return result;
}

Terrain decode_compact(std::string_view bytes) {
  ByteReader reader(unseal_compact(bytes));
  std::uint64_t vertices = 0;
  bool folds = false;
  const CompactFrameFacts facts = read_header(reader, vertices, folds);
  if (bytes[4] != version_for(folds))
    throw CannotRead("damaged: the version is not the one of its kind of surface", {}, "format");
  if (const std::string fault = fault_of(facts); !fault.empty()) throw CannotRead("no terrain: " + fault, {}, "header");
  BitCoder coder(reader.rest());
  try {
    Payload payload = code_payload(coder, facts, vertices, {}, folds, {}, nullptr, {});
    Terrain terrain = assemble(facts, payload);
    if (const std::string fault = find_fault(terrain, true); !fault.empty())
      throw CannotRead("no terrain: " + fault, {}, "surface");
    return terrain;
  } catch (const BadInput& e) {
    throw CannotRead(std::string("no terrain: ") + e.what(), {}, "stream");
  }
}

}  // namespace retalho
