#include "terrain_calls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "detail.h"
#include "models.h"
#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/model/model.h"
#include "retalho/terrain/height_range.h"
#include "retalho/terrain/quantities.h"
#include "retalho/visibility/viewshed.h"
#include "saved_file.h"

namespace retalho::viewer {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kFar = 1e12;  // no coordinate of a terrain lies farther out
constexpr std::size_t kMostContourPoints = 4'000'000;

Json number_or_null(double v) {
  return std::isfinite(v) ? Json(v) : Json(nullptr);
}

/// The first quoted word of the WKT; empty without a CRS.
std::string crs_name(const std::string& wkt) {
  const std::size_t open = wkt.find('"');
  const std::size_t close = open == std::string::npos ? open : wkt.find('"', open + 1);
  return close == std::string::npos ? std::string() : wkt.substr(open + 1, close - open - 1);
}

HeightRange heights_of(const FittedModel& model) {
  if (model.tiles) return {model.tiles->low(), model.tiles->high()};
  return height_range(*model.terrain);
}

/// What the page takes from every coordinate, so that its floats keep their digits: the middle of the file's box. It
/// depends on the file alone: all panels share it.
Vec3 origin_of(const Models& models, std::size_t file) {
  const TerrainInput& input = models.inputs()[file];
  if (input.grid) {
    const Raster& g = *input.grid;
    const Vec2 middle = g.centre((g.columns - 1) / 2.0, (g.rows - 1) / 2.0);
    return {middle.x, middle.y, 0};
  }
  if (input.tiles) return {input.tiles->middle().x, input.tiles->middle().y, 0};
  Vec2 low = input.model->tin.points.at(0), high = low;
  for (const Vec2 p : input.model->tin.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return {(low.x + high.x) / 2, (low.y + high.y) / 2, 0};
}

void push(std::vector<float>& to, Vec3 p, Vec3 origin) {
  to.push_back(static_cast<float>(p.x - origin.x));
  to.push_back(static_cast<float>(p.y - origin.y));
  to.push_back(static_cast<float>(p.z - origin.z));
}

/// The triangulation's edges along the surface: a straight one for flat pieces, four pieces where it is curved; none of
/// a tiled model that is not joined.
std::vector<float> edge_lines(const FittedModel& model, Vec3 origin) {
  if (model.tiles) return {};
  const Tin& tin = model.terrain->tin;
  const EdgeTable& edges = model.evaluator->edges();
  const int pieces = model.terrain->kind == SurfaceKind::linear || edges.vertices.size() > 150'000 ? 1 : 4;
  std::vector<float> lines;
  lines.reserve(edges.vertices.size() * static_cast<std::size_t>(6 * pieces));
  for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
    const auto [a, b] = edges.vertices[e];
    Vec3 from{tin.points[a].x, tin.points[a].y, tin.heights[a]};
    for (int k = 1; k <= pieces; ++k) {
      const Vec2 at = tin.points[a] + (static_cast<double>(k) / pieces) * (tin.points[b] - tin.points[a]);
      const double z = k == pieces ? tin.heights[b] : model.evaluator->jet_in(edges.triangles[e][0], at).value;
      const Vec3 to{at.x, at.y, z};
      push(lines, from, origin);
      push(lines, to, origin);
      from = to;
    }
  }
  return lines;
}

bool is_vector(const Json& v) {
  return v.is_array() && v.size() == 3 && std::all_of(v.begin(), v.end(), [](const Json& one) {
           return one.is_number() && std::abs(one.get<double>()) < kFar;
         });
}

/// {"eye": [x, y, z], "forward", "stretch", "angle", "triangles"}: see detail.h. The eye is in the page's coordinates;
/// without one the surface is seen from straight above and far away, to 1/2000 of its range of heights. Where the
/// triangulation itself takes most of the triangles, half of them come on top.
DetailOptions detail_of(const Json& input, const FittedModel& model, Vec3 origin) {
  DetailOptions options;
  const auto wanted = static_cast<std::size_t>(whole(input, "triangles", 1000, 4'000'000));
  options.budget = model.tiles ? wanted : std::max(wanted, model.terrain->tin.triangle_count() + wanted / 2);
  const auto at = input.find("eye");
  if (at == input.end()) {
    const HeightRange range = heights_of(model);
    options.eye = {origin.x, origin.y, kFar};
    options.angle = std::max(1e-9, (range.high - range.low) / 2000) / kFar;
    return options;
  }
  if (!is_vector(*at)) throw BadInput("'eye' must be three numbers", {}, "eye");
  if (const auto way = input.find("forward"); way != input.end()) {
    if (!is_vector(*way)) throw BadInput("'forward' must be three numbers", {}, "forward");
    options.forward = {(*way)[0].get<double>(), (*way)[1].get<double>(), (*way)[2].get<double>()};
  }
  options.eye = {(*at)[0].get<double>() + origin.x, (*at)[1].get<double>() + origin.y, (*at)[2].get<double>()};
  options.stretch = number(input, "stretch", 1e-3, 1e3);
  options.angle = number(input, "angle", 1e-7, 1);
  return options;
}

/// Positions less the origin, normals and indices.
std::vector<Array> mesh_arrays(const TriangleMesh& mesh, Vec3 origin) {
  std::vector<float> positions, normals;
  positions.reserve(mesh.positions.size() * 3);
  normals.reserve(mesh.normals.size() * 3);
  for (const Vec3 p : mesh.positions) push(positions, p, origin);
  for (const Vec3 n : mesh.normals) push(normals, n, {});
  std::vector<std::uint32_t> indices;
  indices.reserve(mesh.triangles.size() * 3);
  for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  return {make_array("position", positions), make_array("normal", normals), make_array("index", indices)};
}

TriangleMesh seen_mesh(const FittedModel& model, const DetailOptions& options, DetailNotes& notes,
                       const Context& context) {
  if (model.tiles) return model.tiles->detail(options, &notes, context);
  return detail_mesh(*model.evaluator, model.bends, options, &notes, context);
}

Json detail_words(const TriangleMesh& mesh, const DetailNotes& notes) {
  return {{"triangles", mesh.triangles.size()}, {"angle", notes.angle}, {"finest", notes.finest}, {"cut", notes.cut}};
}

Answer files_call(const Models& models, const std::string& first_view) {
  Json list = Json::array();
  for (std::size_t i = 0; i < models.inputs().size(); ++i) {
    const TerrainInput& input = models.inputs()[i];
    const Georef& georef = input.georef();
    Json one = {{"name", input.name},  {"described", input.described},    {"kind", input.grid ? "grid" : "model"},
                {"unit", georef.unit}, {"geographic", georef.geographic}, {"crs", crs_name(georef.crs_wkt)}};
    if (input.grid) {
      const RasterSummary summary = summarize(*input.grid);
      one["columns"] = input.grid->columns;
      one["rows"] = input.grid->rows;
      one["cell"] = std::min(input.grid->cell_width, input.grid->cell_height);
      one["cell_size"] = {input.grid->cell_width, input.grid->cell_height};
      one["low"] = number_or_null(summary.minimum);
      one["high"] = number_or_null(summary.maximum);
      one["valid"] = summary.valid;
    } else if (input.tiles) {
      one["low"] = input.tiles->low();
      one["high"] = input.tiles->high();
      one["cell"] = std::min(input.tiles->index().cell_width, input.tiles->index().cell_height);
    } else {
      const HeightRange range = height_range(*input.model);
      one["low"] = range.low;
      one["high"] = range.high;
      one["cell"] =
          input.model->grid.columns > 0 ? std::min(input.model->grid.cell_width, input.model->grid.cell_height) : 1.0;
    }
    list.push_back(one);
  }
  return {{{"files", list}, {"given", models.given()}, {"first_view", first_view}}};
}

/// Fits, and gives the surface as triangles, as they are seen from the eye.
Answer fit_call(Models& models, const Json& input, const Context& context) {
  const ModelPointer model = models.fit(input, context);
  const HeightRange range = heights_of(*model);
  const Vec3 origin = origin_of(models, model->file);
  DetailNotes notes;
  const TriangleMesh mesh = seen_mesh(*model, detail_of(input, *model, origin), notes, context);
  Json words = report_json(*model);
  words["model"] = model->id;
  words["detail"] = detail_words(mesh, notes);
  words["origin"] = {origin.x, origin.y};
  words["range"] = {range.low, range.high};
  Answer answer{words, mesh_arrays(mesh, origin)};
  answer.arrays.push_back(make_array("edges", edge_lines(*model, origin)));
  return answer;
}

/// The triangles of a model anew, as they are seen from another eye.
Answer detail_call(const Models& models, const Json& input, const Context& context) {
  const ModelPointer model = models.get(input);
  const Vec3 origin = origin_of(models, model->file);
  DetailNotes notes;
  const TriangleMesh mesh = seen_mesh(*model, detail_of(input, *model, origin), notes, context);
  return {detail_words(mesh, notes), mesh_arrays(mesh, origin)};
}

/// Signed error (model less grid) of each block of cells: the one of the largest size in it.
Answer errors_call(const Models& models, const Json& input, const Context& context) {
  const ModelPointer model = models.get(input);
  if (!model->grid) throw BadInput("a model file has no grid beside it: open the DEM to see errors");
  const Raster& grid = *model->grid;
  const auto most = static_cast<int>(whole(input, "size", 16, 4096));
  const int block = (std::max(grid.columns, grid.rows) + most - 1) / most;
  const int columns = (grid.columns + block - 1) / block, rows = (grid.rows + block - 1) / block;
  std::vector<float> error(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
                           std::numeric_limits<float>::quiet_NaN());
  std::vector<double> heights(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(block));
  for (int r = 0; r < rows; ++r) {
    context.check();
    const int first = r * block, count = std::min(block, grid.rows - first);
    const std::size_t cells = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(count);
    model->evaluator->grid_values(grid.centre(0, first), {grid.cell_width, grid.cell_height}, grid.columns, count,
                                  std::span(heights).first(cells), {}, context);
    for (std::size_t i = 0; i < cells; ++i) {
      const double e = heights[i] - grid.at(grid.index(0, first) + i);
      const auto column = static_cast<int>(i % static_cast<std::size_t>(grid.columns));
      float& kept = error[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) +
                          static_cast<std::size_t>(column / block)];
      if (!std::isnan(e) && !(std::abs(e) <= static_cast<double>(std::abs(kept)))) kept = static_cast<float>(e);
    }
    context.report("errors", static_cast<double>(r + 1) / rows);
  }
  // The picture's box: outer edges of the first and the last block, less the page's origin.
  const Vec3 origin = origin_of(models, model->file);
  const double west = -0.5 * grid.cell_width - origin.x, north = 0.5 * grid.cell_height - origin.y;
  return {{{"columns", columns},
           {"rows", rows},
           {"block", block},
           {"box", {west, north, columns * block * grid.cell_width, rows * block * grid.cell_height}}},
          {make_array("error", error)}};
}

/// Levels that are not too many for a page.
std::vector<double> shown_levels(HeightRange range, double interval, double base) {
  const double beyond = 0.25 * (range.high - range.low);  // a smooth surface may rise above its vertices
  std::vector<double> levels = contour_levels(range.low - beyond, range.high + beyond, interval, base);
  if (levels.size() > 2000)
    throw BadInput(fmt::format("an interval of {:.6g} makes {} levels: choose a larger one", interval, levels.size()),
                   {}, "interval");
  return levels;
}

ContourSet contours_of(const FittedModel& model, double interval, double base, const Context& context) {
  const auto check_points = [](std::size_t points) {
    if (points > kMostContourPoints)
      throw BadInput("these contours have too many points to draw: choose a larger interval", {}, "interval");
  };
  if (model.tiles) {
    const SurfaceRange range = model.tiles->range(context);
    return model.tiles->contours(shown_levels({range.low, range.high}, interval, base), check_points, context);
  }
  const Terrain& terrain = *model.terrain;
  const double cell = terrain.grid.columns > 0 ? std::min(terrain.grid.cell_width, terrain.grid.cell_height)
                                               : norm(terrain.tin.points.at(0) - terrain.tin.points.at(1));
  ContourSet set =
      trace_contours(terrain, shown_levels(height_range(terrain), interval, base), {.tolerance = 0.1 * cell}, context);
  check_points(set.points.size());
  return set;
}

Answer contours_call(const Models& models, const Json& input, const Context& context) {
  const ModelPointer model = models.get(input);
  const double interval = number(input, "interval", 1e-9, 1e9), base = number_or(input, "base", -1e9, 1e9, 0);
  const ContourSet set = contours_of(*model, interval, base, context);
  const Vec3 origin = origin_of(models, model->file);
  std::vector<float> segments;
  std::vector<std::uint8_t> major;
  std::size_t closed = 0;
  for (const ContourLine& line : set.lines) {
    closed += line.closed ? 1 : 0;
    const double z = set.levels[static_cast<std::size_t>(line.level)];
    const bool index = std::abs(std::remainder((z - base) / interval, 5)) < 0.25;
    const std::size_t n = line.end - line.begin, pieces = line.closed ? n : n - 1;
    for (std::size_t k = 0; k < pieces; ++k)
      for (const std::size_t at : {line.begin + k, line.begin + (k + 1) % n}) {
        push(segments, {set.points[at].x, set.points[at].y, z}, origin);
        major.push_back(index ? 255 : 0);
      }
  }
  return {{{"levels", set.levels.size()},
           {"lines", set.lines.size()},
           {"closed_lines", closed},
           {"vertices", set.points.size()},
           {"singular", set.singular.size()},
           {"tolerance", set.tolerance}},
          {make_array("segments", segments), make_array("major", major)}};
}

Vec2 local_point(const Models& models, const FittedModel& model, const Json& input) {
  const Vec3 origin = origin_of(models, model.file);
  return {number(input, "x", -kFar, kFar) + origin.x, number(input, "y", -kFar, kFar) + origin.y};
}

/// Between cell centres as the grid is drawn elsewhere (bilinear); void where one of the four cells is.
double between_cells(const Raster& grid, Vec2 local) {
  const double column = local.x / grid.cell_width, row = -local.y / grid.cell_height;
  if (!(column >= 0 && row >= 0 && column <= grid.columns - 1 && row <= grid.rows - 1)) return kNan;
  const int c = std::min(static_cast<int>(column), grid.columns - 2),
            r = std::min(static_cast<int>(row), grid.rows - 2);
  if (c < 0 || r < 0) return kNan;
  const double u = column - c, v = row - r;
  return (1 - v) * ((1 - u) * grid.at(c, r) + u * grid.at(c + 1, r)) +
         v * ((1 - u) * grid.at(c, r + 1) + u * grid.at(c + 1, r + 1));
}

/// The cell whose centre is nearest.
double grid_height(const Raster& grid, Vec2 local) {
  const double column = std::round(local.x / grid.cell_width), row = std::round(-local.y / grid.cell_height);
  if (!(column >= 0 && row >= 0 && column < grid.columns && row < grid.rows)) return kNan;
  return grid.at(static_cast<int>(column), static_cast<int>(row));
}

Answer at_call(const Models& models, const Json& input) {
  const ModelPointer model = models.get(input);
  const Georef& georef = model->georef();
  const Vec3 origin = origin_of(models, model->file);
  const Vec2 local = input.contains("crs_x")
                         ? georef.to_local({number(input, "crs_x", -kFar, kFar), number(input, "crs_y", -kFar, kFar)})
                         : local_point(models, *model, input);
  const Vec2 crs = georef.to_crs(local);
  const std::optional<Jet> jet = model->jet(local);
  Json words = {{"x", crs.x},
                {"y", crs.y},
                {"valid", jet.has_value()},
                {"local_x", local.x - origin.x},
                {"local_y", local.y - origin.y}};
  if (jet) {
    words["z"] = jet->value;
    words["slope"] = slope_degrees(jet->gradient);
    words["aspect"] = number_or_null(aspect_degrees(jet->gradient));
    words["curvature"] = mean_curvature(*jet);
  }
  if (model->grid) words["grid"] = number_or_null(grid_height(*model->grid, local));
  return {words};
}

/// Heights along a drawn line, for each model named, and the grid's own cells.
Answer profile_call(const Models& models, const Json& input) {
  const auto at = input.find("points");
  if (at == input.end() || !at->is_array() || at->size() < 2 || at->size() > 200)
    throw BadInput("'points' must be 2 to 200 places {x, y}", {}, "points");
  const ModelPointer model = models.get(input);
  std::vector<Vec2> corners;
  double length = 0;
  for (const Json& p : *at) {
    if (!p.is_object()) throw BadInput("'points' must be 2 to 200 places {x, y}", {}, "points");
    corners.push_back(local_point(models, *model, p));
    if (corners.size() > 1) length += norm(corners.back() - corners[corners.size() - 2]);
  }
  const auto count = static_cast<std::size_t>(whole(input, "count", 2, 5000));
  std::vector<double> distance, surface, grid;
  std::size_t piece = 0;
  double before = 0;  // length of the pieces that lie behind
  for (std::size_t k = 0; k < count; ++k) {
    const double d = length * static_cast<double>(k) / static_cast<double>(count - 1);
    while (piece + 2 < corners.size() && d > before + norm(corners[piece + 1] - corners[piece])) {
      before += norm(corners[piece + 1] - corners[piece]);
      ++piece;
    }
    const Vec2 step = corners[piece + 1] - corners[piece];
    const double along = norm(step) > 0 ? std::clamp((d - before) / norm(step), 0.0, 1.0) : 0.0;
    const Vec2 p = corners[piece] + along * step;
    distance.push_back(d);
    const std::optional<Jet> jet = model->jet(p);
    surface.push_back(jet ? jet->value : kNan);
    grid.push_back(model->grid ? between_cells(*model->grid, p) : kNan);
  }
  return {{{"length", length}, {"unit", model->georef().unit}},
          {make_array("distance", distance), make_array("surface", surface), make_array("grid", grid)}};
}

/// The model file's bytes, as `retalho fit` writes them; or triangles, as `retalho mesh` makes them of it when it is
/// given no tolerance.
Answer save_call(const Models& models, const Json& input, const Context& context) {
  const std::string format = save_format(input);
  const ModelPointer model = models.get(input);
  if (model->tiles)
    throw BadInput(
        "a tiled model is not joined by the page: its folder is its file, and `retalho mesh` makes triangles "
        "of it",
        {}, "format");
  if (format == "retalho") return saved_model(encode_model(*model->terrain));
  return saved_mesh(mesh_terrain(*model->terrain, {}, context), format);
}

Answer viewshed_call(Models& models, const Json& input, const Context& context) {
  const ModelPointer model = models.get(input);
  ViewshedOptions options;
  options.radius = number_or(input, "radius", 0, kFar, 0);
  const Vec2 place = local_point(models, *model, input);
  const auto& [grid, corner] = models.grid_of(*model, place, options.radius, context);
  const Observer observer = observer_at(*grid, model->georef().to_crs(place), number(input, "height", 0, 1e5));
  options.target_height = number_or(input, "target_height", 0, 1e5, 0);
  const std::vector<std::uint8_t> seen = viewshed(*grid, observer, options, context);
  const auto visible = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1));
  // At most 2,048 cells a side go to the page: a block is seen where its middle cell is.
  const int block = (std::max(grid->columns, grid->rows) + 2047) / 2048;
  const int columns = (grid->columns + block - 1) / block, rows = (grid->rows + block - 1) / block;
  std::vector<std::uint8_t> picture;
  picture.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int column = std::min(c * block + block / 2, grid->columns - 1);
      const int row = std::min(r * block + block / 2, grid->rows - 1);
      picture.push_back(seen[grid->index(column, row)] ? 255 : 0);
    }
  const Vec3 origin = origin_of(models, model->file);
  const Vec2 cell = grid->centre(observer.column, observer.row) + corner;
  return {{{"visible_cells", visible},
           {"cells", grid->cells()},
           {"columns", columns},
           {"rows", rows},
           {"observer", {cell.x - origin.x, cell.y - origin.y}},
           {"ground", grid->at(observer.column, observer.row)},
           {"box",
            {corner.x - 0.5 * grid->cell_width - origin.x, corner.y + 0.5 * grid->cell_height - origin.y,
             columns * block * grid->cell_width, rows * block * grid->cell_height}}},
          {make_array("seen", picture)}};
}

}  // namespace

void add_terrain_calls(CallTable& table, const InputFiles& inputs) {
  const auto models = std::make_shared<Models>(inputs);
  using Kind = Call::Kind;
  table["/api/terrain/files"] = {Kind::quick, [models, first = inputs.first_view](const Json&, const Context&) {
                                   return files_call(*models, first);
                                 }};
  table["/api/terrain/fit"] = {
      Kind::slow, [models](const Json& in, const Context& context) { return fit_call(*models, in, context); }};
  table["/api/terrain/detail"] = {
      Kind::quick, [models](const Json& in, const Context& context) { return detail_call(*models, in, context); }};
  table["/api/terrain/errors"] = {
      Kind::slow, [models](const Json& in, const Context& context) { return errors_call(*models, in, context); }};
  table["/api/terrain/contours"] = {
      Kind::slow, [models](const Json& in, const Context& context) { return contours_call(*models, in, context); }};
  table["/api/terrain/at"] = {Kind::quick, [models](const Json& in, const Context&) { return at_call(*models, in); }};
  table["/api/terrain/profile"] = {Kind::quick,
                                   [models](const Json& in, const Context&) { return profile_call(*models, in); }};
  table["/api/terrain/save"] = {
      Kind::slow, [models](const Json& in, const Context& context) { return save_call(*models, in, context); }};
  table["/api/terrain/viewshed"] = {
      Kind::slow, [models](const Json& in, const Context& context) { return viewshed_call(*models, in, context); }};
}

}  // namespace retalho::viewer
