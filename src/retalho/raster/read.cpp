// read_raster: GDAL's bands and ASCII PGM as a north-up Raster.
#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <new>

#include "retalho/core/error.h"
#include "retalho/raster/claim.h"
#include "retalho/raster/gdal.h"
#include "retalho/raster/height_sink.h"
#include "retalho/raster/io.h"
#include "retalho/raster/pgm.h"

namespace retalho {
namespace {

constexpr float kVoid = std::numeric_limits<float>::quiet_NaN();

/// What a stored value must be to mean "no height": the band's own no-data value and the caller's.
struct VoidRule {
  std::optional<double> stored;       // the file's, in stored values
  std::optional<std::int64_t> int64;  // the same of a 64-bit band, where double is not exact
  std::optional<std::uint64_t> uint64;
  std::optional<double> height;  // the caller's, in heights
};

struct FileHandle {
  explicit FileHandle(const std::string& path) : file(VSIFOpenL(path.c_str(), "rb")) {}
  ~FileHandle() {
    if (file) VSIFCloseL(file);
  }
  FileHandle(const FileHandle&) = delete;
  FileHandle& operator=(const FileHandle&) = delete;
  VSILFILE* file;
};

bool is_ascii_pgm(const std::string& path) {
  if (path.find('<') != std::string::npos) return false;
  const FileHandle handle(path);
  char head[3] = {};
  if (!handle.file || VSIFReadL(head, 1, sizeof head, handle.file) < 2 || head[0] != 'P' || head[1] != '2')
    return false;
  return head[2] == '#' || head[2] == ' ' || head[2] == '\0' || (head[2] >= '\t' && head[2] <= '\r');
}

/// Turns infinite heights and heights equal to the caller's no-data value into voids, for sources without rules of
/// their own.
void apply_nodata(Raster& raster, const std::optional<double>& nodata) {
  if (!nodata) return;
  std::visit(
      [&](auto& heights) {
        for (auto& h : heights)
          if (static_cast<double>(h) == *nodata) h = static_cast<std::remove_reference_t<decltype(h)>>(kVoid);
      },
      raster.heights);
}

Raster read_ascii_pgm(const std::string& path, const ReadOptions& options, ReadNotes& notes, const Context& context) {
  if (options.band != 1)
    throw BadInput(fmt::format("'{}' has no band {}: a PGM has one band", path, options.band), path);
  const FileHandle handle(path);
  if (!handle.file) throw CannotRead(fmt::format("cannot open '{}'", path), path);
  std::error_code ec;
  const auto bytes = std::filesystem::file_size(path, ec);  // not of GDAL's own file systems, whose archives unpack
  Raster raster = read_pgm([&](char* to, std::size_t size) { return VSIFReadL(to, 1, size, handle.file); }, path,
                           context, ec ? std::nullopt : std::optional<std::uint64_t>(bytes));
  apply_nodata(raster, options.nodata);
  notes.driver = "PGM (ASCII)";
  notes.data_type = "ASCII integer";
  return raster;
}

[[noreturn]] void refuse_part_of_pgm(const std::string& path) {
  throw BadInput(fmt::format("'{}': no part of an ASCII PGM can be read by itself: make a GeoTIFF of it first "
                             "(retalho fit and retalho sample, or another converter)",
                             path),
                 path);
}

DatasetPtr open(const std::string& path, const std::string& name, const GdalMessages& messages) {
  std::error_code ec;
  if (path.empty()) throw CannotRead("no file name was given");
  const bool plain = !path.starts_with("/vsi") && path.find_first_of("<:\"{") == std::string::npos;
  if (plain && !std::filesystem::exists(path, ec)) throw CannotRead(fmt::format("'{}' does not exist", name), name);
  DatasetPtr dataset(static_cast<GDALDataset*>(
      GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr)));
  if (dataset) return dataset;
  if (plain && std::filesystem::is_directory(path, ec))
    throw CannotRead(fmt::format("'{}' is a folder: give the name of a raster file", name), name);
  throw CannotRead(
      fmt::format("cannot read '{}' as an elevation grid: {}", name, messages.words("GDAL does not open it")), name);
}

GDALRasterBand& choose_band(GDALDataset& dataset, int band, const std::string& name) {
  const int bands = dataset.GetRasterCount();
  if (bands == 0) {
    std::string inside;
    for (char** item = dataset.GetMetadata("SUBDATASETS"); item && *item; ++item)
      if (const char* value = std::strstr(*item, "_NAME=")) inside += fmt::format("\n  {}", value + 6);
    throw BadInput(fmt::format("'{}' holds no raster band{}", name,
                               inside.empty() ? "" : " of its own; give one of the rasters inside it:" + inside),
                   name);
  }
  if (band < 1 || band > bands)
    throw BadInput(fmt::format("'{}' has no band {}: it has bands 1 to {}", name, band, bands), name,
                   fmt::format("band {}", band));
  return *dataset.GetRasterBand(band);
}

/// The affine map from (column, row) of the file to the CRS, or nothing.
std::optional<std::array<double, 6>> transform(GDALDataset& dataset, const std::string& name) {
  std::array<double, 6> gt{};
  if (dataset.GetGeoTransform(gt.data()) == CE_None) {
    for (const double v : gt)
      if (!std::isfinite(v))
        throw BadInput(fmt::format("'{}': the geotransform holds a number that is not finite", name), name);
    return gt;
  }
  if (dataset.GetGCPCount() == 0) return std::nullopt;
  if (GDALGCPsToGeoTransform(dataset.GetGCPCount(), dataset.GetGCPs(), gt.data(), FALSE)) return gt;
  throw BadInput(
      fmt::format("'{}' is placed by ground control points that are not on a straight grid: warp it first (gdalwarp)",
                  name),
      name);
}

struct Placement {
  bool flip_rows = false, flip_columns = false;
};

Placement place(GDALDataset& dataset, const std::string& name, Raster& raster, ReadNotes& notes) {
  const OGRSpatialReference* crs = dataset.GetSpatialRef();
  if (!crs) crs = dataset.GetGCPSpatialRef();
  Placement placement;
  const auto found = transform(dataset, name);
  if (!found) {
    if (crs && !crs->IsEmpty())
      notes.remarks.push_back("the file names a CRS but no place: cells are 1 unit wide and the CRS is left out");
    return placement;
  }
  const auto& gt = *found;
  if (gt[1] == 0 || gt[5] == 0) {
    if (gt[2] != 0 && gt[4] != 0)
      throw BadInput(
          fmt::format("'{}': the grid is rotated by a quarter turn: warp it north-up first (gdalwarp)", name), name);
    throw BadInput(fmt::format("'{}': the cells have no size ({} x {})", name, gt[1], gt[5]), name);
  }
  // Rounding in a file's transform may leave crumbs; a shift of a thousandth of a cell over the whole grid is none.
  if (std::abs(gt[2]) * raster.rows > 1e-3 * std::abs(gt[1]) ||
      std::abs(gt[4]) * raster.columns > 1e-3 * std::abs(gt[5]))
    throw BadInput(fmt::format("'{}': the grid is rotated or sheared (geotransform {}, {}, {}, {}, {}, {}): warp it "
                               "north-up first (gdalwarp)",
                               name, gt[0], gt[1], gt[2], gt[3], gt[4], gt[5]),
                   name, "geotransform");
  const double reach_x = std::max(std::abs(gt[0]), std::abs(gt[0] + raster.columns * gt[1]));
  const double reach_y = std::max(std::abs(gt[3]), std::abs(gt[3] + raster.rows * gt[5]));
  constexpr double kDigits = 1e-13;  // of double's 1.1e-16: cells keep three digits of their size
  if (!(std::abs(gt[1]) > kDigits * reach_x && std::abs(gt[5]) > kDigits * reach_y))
    throw BadInput(fmt::format("'{}': cells of {} x {} cannot be told apart at ({}, {}): the geotransform is damaged",
                               name, std::abs(gt[1]), std::abs(gt[5]), gt[0], gt[3]),
                   name, "geotransform");
  placement.flip_columns = gt[1] < 0;
  placement.flip_rows = gt[5] > 0;
  const double column = placement.flip_columns ? raster.columns - 0.5 : 0.5;
  const double row = placement.flip_rows ? raster.rows - 0.5 : 0.5;
  raster.georef.origin_x = gt[0] + column * gt[1];
  raster.georef.origin_y = gt[3] + row * gt[5];
  const double middle = gt[3] + 0.5 * raster.rows * gt[5];
  notes.crs_name = describe_crs(crs, middle, raster.georef, notes.remarks);
  raster.cell_width = std::abs(gt[1]) * raster.georef.scale_x;
  raster.cell_height = std::abs(gt[5]) * raster.georef.scale_y;
  return placement;
}

VoidRule void_rule(GDALRasterBand& band, const ReadOptions& options, ReadNotes& notes) {
  VoidRule rule;
  int has = 0;
  if (band.GetRasterDataType() == GDT_Int64) {
    const std::int64_t value = band.GetNoDataValueAsInt64(&has);
    if (has) rule.int64 = value, notes.nodata = static_cast<double>(value);
  } else if (band.GetRasterDataType() == GDT_UInt64) {
    const std::uint64_t value = band.GetNoDataValueAsUInt64(&has);
    if (has) rule.uint64 = value, notes.nodata = static_cast<double>(value);
  } else {
    const double value = band.GetNoDataValue(&has);
    if (has) rule.stored = notes.nodata = value;
  }
  rule.height = options.nodata;
  return rule;
}

/// Calls `body(first row, rows)`, counted in the window, for the bands of rows in which the file is stored, each small
/// enough for a buffer.
template <class Body>
void by_block_rows(GDALRasterBand& band, const CellWindow& window, std::size_t bytes_a_cell, const Context& context,
                   const Body& body) {
  constexpr std::size_t kBuffer = std::size_t{4} << 20;
  int block_width = 0, block_height = 1;
  band.GetBlockSize(&block_width, &block_height);
  const std::size_t fit = std::max<std::size_t>(1, kBuffer / (static_cast<std::size_t>(window.columns) * bytes_a_cell));
  int step = static_cast<int>(std::min<std::size_t>(fit, static_cast<std::size_t>(window.rows)));
  if (step > block_height) step -= step % block_height;
  for (int row = 0, count = 0; row < window.rows; row += count) {
    context.check();
    const int in_block = (window.row + row) % block_height;  // the first band may start inside of a block
    count = std::min(step, window.rows - row);
    if (in_block != 0 || step < block_height) count = std::min(count, block_height - in_block);
    body(row, count);
    context.report("read", static_cast<double>(row + count) / window.rows);
    // Blocks that were read are not needed again; without this GDAL's cache may hold a second copy of the grid.
    if ((window.row + row + count) % block_height == 0) band.FlushCache(false);
  }
}

class BandReader {
 public:
  /// `window`: in the file's own order of rows and columns.
  BandReader(GDALRasterBand& band, const CellWindow& window, const std::string& name, const GdalMessages& messages,
             const VoidRule& rule, ReadNotes& notes, const Context& context)
      : band_(band),
        window_(window),
        name_(name),
        messages_(messages),
        rule_(rule),
        notes_(notes),
        context_(context),
        columns_(static_cast<std::size_t>(window.columns)),
        cells_(columns_ * static_cast<std::size_t>(window.rows)) {
    const int flags = band.GetMaskFlags();
    if ((flags & (GMF_PER_DATASET | GMF_ALPHA)) != 0 && (flags & GMF_ALL_VALID) == 0) mask_ = band.GetMaskBand();
  }

  std::variant<std::vector<float>, std::vector<double>> read() {
    const bool scaled = notes_.scale != 1 || notes_.offset != 0;
    switch (band_.GetRasterDataType()) {
      case GDT_Byte:
      case GDT_UInt16:
      case GDT_Int16:
      case GDT_Float32:
        if (!scaled) return read_floats();
        return read_wide<double>(GDT_Float64);
      case GDT_Int64:
        return read_wide<std::int64_t>(GDT_Int64);
      case GDT_UInt64:
        return read_wide<std::uint64_t>(GDT_UInt64);
      default:
        return read_wide<double>(GDT_Float64);
    }
  }

 private:
  void fetch(GDALRasterBand& from, int row, int rows, void* to, GDALDataType type) const {
    const int columns = static_cast<int>(columns_);
    const CPLErr outcome = from.RasterIO(GF_Read, window_.column, window_.row + row, columns, rows, to, columns, rows,
                                         type, 0, 0, nullptr);
    if (outcome == CE_None && !messages_.failed()) return;
    throw CannotRead(
        fmt::format("'{}' is damaged or cut off: {} (rows {} to {})", name_, messages_.words("GDAL cannot read it"),
                    window_.row + row, window_.row + row + rows - 1),
        name_, fmt::format("rows {} to {}", window_.row + row, window_.row + row + rows - 1));
  }

  void fetch_mask(int row, int rows) {
    if (!mask_) return;
    mask_row_.resize(columns_ * static_cast<std::size_t>(rows));
    fetch(*mask_, row, rows, mask_row_.data(), GDT_Byte);
  }
  bool masked(std::size_t k) const { return mask_ && mask_row_[k] == 0; }

  /// Stored values that float holds exactly, straight into their place.
  std::vector<float> read_floats() {
    const auto as_float = [](double v) {
      return std::abs(v) > static_cast<double>(std::numeric_limits<float>::max()) && std::isfinite(v)
                 ? std::copysign(std::numeric_limits<float>::max(), static_cast<float>(v))
                 : static_cast<float>(v);
    };
    // A NaN that nothing equals stands for "no such rule".
    const float first = rule_.stored ? as_float(*rule_.stored) : kVoid,
                second = rule_.height ? as_float(*rule_.height) : kVoid;
    std::vector<float> heights;
    heights.reserve(cells_);  // address space; pages are taken as rows arrive, so a false claim costs nothing
    by_block_rows(band_, window_, sizeof(float), context_, [&](int row, int rows) {
      heights.resize(static_cast<std::size_t>(row + rows) * columns_);
      float* const start = heights.data() + static_cast<std::size_t>(row) * columns_;
      fetch(band_, row, rows, start, GDT_Float32);
      fetch_mask(row, rows);
      for (std::size_t k = 0; k < columns_ * static_cast<std::size_t>(rows); ++k) {
        float& h = start[k];
        if (h == first || h == second || masked(k)) {
          h = kVoid;
        } else if (std::isinf(h)) {
          ++notes_.infinite;
          h = kVoid;
        }
      }
    });
    return heights;
  }

  bool is_void(double v) const { return rule_.stored && v == *rule_.stored; }
  bool is_void(std::int64_t v) const { return rule_.int64 && v == *rule_.int64; }
  bool is_void(std::uint64_t v) const { return rule_.uint64 && v == *rule_.uint64; }

  /// Any other values: through a buffer, float as long as that is exact.
  template <class Stored>
  std::variant<std::vector<float>, std::vector<double>> read_wide(GDALDataType type) {
    const bool scaled = notes_.scale != 1 || notes_.offset != 0;
    HeightSink sink(cells_);
    std::vector<Stored> buffer;
    std::size_t rounded = 0;
    by_block_rows(band_, window_, sizeof(Stored), context_, [&](int row, int rows) {
      buffer.resize(columns_ * static_cast<std::size_t>(rows));
      fetch(band_, row, rows, buffer.data(), type);
      fetch_mask(row, rows);
      for (std::size_t k = 0; k < buffer.size(); ++k) {
        double h = static_cast<double>(buffer[k]);
        if (scaled) h = h * notes_.scale + notes_.offset;
        if (is_void(buffer[k]) || masked(k) || (rule_.height && h == *rule_.height)) {
          h = static_cast<double>(kVoid);
        } else if (std::isinf(h)) {
          ++notes_.infinite;
          h = static_cast<double>(kVoid);
        } else if constexpr (std::is_integral_v<Stored>) {
          if (std::abs(static_cast<double>(buffer[k])) > 9007199254740992.0) ++rounded;
        }
        sink.add(h);
      }
    });
    if (rounded > 0) notes_.remarks.push_back(fmt::format("{} heights beyond 2^53 are rounded to double", rounded));
    return sink.take();
  }

  GDALRasterBand& band_;
  CellWindow window_;
  const std::string& name_;
  const GdalMessages& messages_;
  const VoidRule& rule_;
  ReadNotes& notes_;
  const Context& context_;
  std::size_t columns_, cells_;
  GDALRasterBand* mask_ = nullptr;
  std::vector<unsigned char> mask_row_;
};

void read_scale(GDALRasterBand& band, const std::string& name, ReadNotes& notes) {
  int has = 0;
  const double scale = band.GetScale(&has);
  if (has) notes.scale = scale;
  const double offset = band.GetOffset(&has);
  if (has) notes.offset = offset;
  if (!std::isfinite(notes.scale) || notes.scale == 0 || !std::isfinite(notes.offset))
    throw BadInput(
        fmt::format("'{}': the band's scale {} and offset {} make no heights", name, notes.scale, notes.offset), name);
}

void reorder(Raster& raster, const Placement& placement) {
  std::visit(
      [&](auto& heights) {
        const auto row = [&](int r) { return heights.begin() + static_cast<std::ptrdiff_t>(r) * raster.columns; };
        if (placement.flip_rows)
          for (int r = 0; r < raster.rows / 2; ++r) std::swap_ranges(row(r), row(r + 1), row(raster.rows - 1 - r));
        if (placement.flip_columns)
          for (int r = 0; r < raster.rows; ++r) std::reverse(row(r), row(r + 1));
      },
      raster.heights);
}

/// The window as the file orders its cells. Throws UsageError where it leaves the grid.
CellWindow in_file(const CellWindow& window, const Raster& whole, const Placement& placement) {
  if (window.column < 0 || window.row < 0 || window.columns < 1 || window.rows < 1 ||
      window.columns > whole.columns - window.column || window.rows > whole.rows - window.row)
    throw UsageError(fmt::format("the window of {} x {} cells at {}, {} leaves the grid of {} x {}", window.columns,
                                 window.rows, window.column, window.row, whole.columns, whole.rows));
  CellWindow file = window;
  if (placement.flip_columns) file.column = whole.columns - window.column - window.columns;
  if (placement.flip_rows) file.row = whole.rows - window.row - window.rows;
  return file;
}

/// Moves the grid's place to that of its window.
void move_to(const CellWindow& window, Raster& raster) {
  raster.georef.origin_x += window.column * (raster.cell_width / raster.georef.scale_x);
  raster.georef.origin_y -= window.row * (raster.cell_height / raster.georef.scale_y);
  raster.columns = window.columns;
  raster.rows = window.rows;
}

Raster read_gdal(const std::string& path, const ReadOptions& options, bool heights, ReadNotes& notes,
                 const Context& context) {
  const GdalMessages messages;
  const std::string name = name_for_message(path);
  const DatasetPtr dataset = open(path, name, messages);
  GDALRasterBand& band = choose_band(*dataset, options.band, name);
  const GDALDataType type = band.GetRasterDataType();
  notes.driver = dataset->GetDriverName();
  notes.data_type = GDALGetDataTypeName(type);
  notes.bands = dataset->GetRasterCount();
  if (GDALDataTypeIsComplex(type))
    throw BadInput(
        fmt::format("'{}': band {} holds complex numbers ({}), not heights", name, options.band, notes.data_type), name,
        fmt::format("band {}", options.band));
  if (band.GetColorTable())
    notes.remarks.push_back("the band has a colour table: its values are taken as heights all the same");

  Raster raster;
  raster.columns = band.GetXSize();
  raster.rows = band.GetYSize();
  raster.height_unit = band.GetUnitType();
  read_scale(band, name, notes);
  const Placement placement = place(*dataset, name, raster, notes);
  if (!heights) return raster;
  const CellWindow window = options.window.value_or(CellWindow{0, 0, raster.columns, raster.rows});
  const CellWindow file = in_file(window, raster, placement);
  const bool wide = GDALGetDataTypeSizeBytes(type) > 4 || type == GDT_Int32 || type == GDT_UInt32 || notes.scale != 1 ||
                    notes.offset != 0;
  check_claim(window.columns, window.rows, wide ? sizeof(float) + sizeof(double) : sizeof(float), name);
  if (options.window) move_to(window, raster);
  const VoidRule rule = void_rule(band, options, notes);
  raster.heights = BandReader(band, file, name, messages, rule, notes, context).read();
  reorder(raster, placement);
  for (const std::string& warning : messages.warnings()) notes.remarks.push_back("GDAL: " + warning);
  if (notes.infinite > 0) notes.remarks.push_back(fmt::format("{} infinite heights are taken as void", notes.infinite));
  return raster;
}

}  // namespace

Raster read_raster(const std::string& path, const ReadOptions& options, ReadNotes* notes, const Context& context) {
  register_gdal();
  ReadNotes own;
  ReadNotes& into = notes ? *notes : own;
  into = {};
  try {
    if (!is_ascii_pgm(path)) return read_gdal(path, options, true, into, context);
    if (options.window) refuse_part_of_pgm(path);
    return read_ascii_pgm(path, options, into, context);
  } catch (const std::bad_alloc&) {
    throw BadInput(fmt::format("'{}' does not fit into memory", name_for_message(path)), name_for_message(path));
  }
}

Raster inspect_raster(const std::string& path, const ReadOptions& options) {
  register_gdal();
  if (is_ascii_pgm(path)) refuse_part_of_pgm(path);
  ReadNotes notes;
  return read_gdal(path, options, false, notes, {});
}

}  // namespace retalho
