// retalho render: grids and models as one picture, side by side.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "fitting.h"
#include "inputs.h"
#include "needs_in_space.h"
#include "render_patches.h"
#include "render_tetraquad.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/render/compose.h"
#include "retalho/render/perspective.h"
#include "retalho/tiles/source.h"

namespace retalho::app {
namespace {

constexpr int kPanelPixels = 480;  // a panel's longer side, when no --size is given
constexpr int kProbe = 256;        // a side of the window in which ranges are looked for
const std::vector<std::string> kViews{"plan", "perspective"};
const std::vector<std::string> kColors{"hypsometric", "gray"};

struct Options {
  std::vector<std::string> inputs;
  std::string output, size, view = "plan", colors = "hypsometric", error;
  std::string light = "315,45";
  std::optional<double> exaggeration, from;
  double elevation = 35;
  bool captions = true;
  GridFlags grid;
  TetraQuadFlags tetraquad;
  std::string style = "lines";
  TileMemoryFlag tile_memory;
};

/// One of the inputs: a grid or a model, ready to be drawn. Not to be moved: the source refers to it.
struct Shape {
  std::optional<Raster> raster;
  std::optional<Terrain> terrain;
  std::optional<TerrainEvaluator> evaluator;
  std::optional<TileReader> tiles;
  VertexBox box;  // of the tiles
  FieldSource source;
  std::vector<std::string> caption;

  const Georef& georef() const { return raster ? raster->georef : tiles ? tiles->index().georef : terrain->georef; }
  Extent extent() const {
    if (tiles) return {{box.low.x, box.low.y}, {box.high.x, box.high.y}};
    return raster ? extent_of(*raster) : extent_of(*terrain);
  }
};

/// A tiled model: windows of it are sampled tile by tile.
void open_tiles(Shape& shape, const Options& options, const std::string& path, const std::string& name,
                const Context& context) {
  shape.tiles.emplace(path, options.tile_memory.bytes());
  shape.box = vertex_box(tile_source(path, options.tile_memory.bytes()), context);
  if (!shape.box.data) throw CannotRead(fmt::format("no tile of '{}' holds any data", path), path);
  shape.source = field_of(*shape.tiles);
  const TiledIndex& index = shape.tiles->index();
  shape.caption = {name, fmt::format("{}, {} x {} cells in {} tiles", surface_name(index.surface), index.columns,
                                     index.rows, index.tiles.size())};
}

std::unique_ptr<Shape> load_shape(const Program& program, const Options& options, const std::string& path,
                                  const Context& context) {
  auto shape = std::make_unique<Shape>();
  std::string name = std::filesystem::path(path).filename().string();
  if (is_tiled_model(path)) {
    if (name.empty()) name = std::filesystem::path(path).parent_path().filename().string();
    open_tiles(*shape, options, path, name, context);
    return shape;
  }
  if (is_model_file(path) || std::filesystem::path(path).extension() == ".retalho") {
    shape->terrain = load_terrain(path);
    check_terrain_need("drawing", *shape->terrain, kVertexLoaded, 0, path);
    shape->evaluator.emplace(*shape->terrain, context);
    shape->source = field_of(*shape->evaluator);
    const ModelReport facts = facts_of(*shape->terrain);
    shape->caption = {name, fmt::format("{}, {} vertices", kind_text(facts), facts.vertices)};
    return shape;
  }
  RasterSummary summary;
  shape->raster = load_grid(program, path, options.grid, summary, context);
  if (summary.valid == 0) throw BadInput(fmt::format("'{}' has no valid cell to draw", path), path);
  shape->source = field_of(*shape->raster);
  shape->caption = {name, fmt::format("grid, {} x {} cells", shape->raster->columns, shape->raster->rows)};
  return shape;
}

/// What all panels share, so that they can be compared by eye.
struct Scene {
  Georef georef;
  Extent extent;
  ReliefOptions relief;
  double base = 0;
};

ReliefOptions parse_relief(const Options& options) {
  ReliefOptions relief;
  const Vec2 light = parse_point("--light", options.light);
  if (light.y <= 0 || light.y > 90)
    throw UsageError(fmt::format("--light: the altitude must be above 0 and at most 90 degrees, not {}", light.y), {},
                     "--light");
  relief.azimuth = light.x;
  relief.altitude = light.y;
  if (options.exaggeration && (!std::isfinite(*options.exaggeration) || *options.exaggeration <= 0))
    throw UsageError("--exaggeration must be above 0", {}, "--exaggeration");
  if (!(options.elevation > 0 && options.elevation < 90))
    throw UsageError("--elevation must be between 0 and 90 degrees", {}, "--elevation");
  if (options.from && !std::isfinite(*options.from))
    throw UsageError("--from must be a number of degrees", {}, "--from");
  relief.ramp = choose("--colors", options.colors, kColors) == 1 ? ColorRamp::gray : ColorRamp::hypsometric;
  return relief;
}

Scene make_scene(const Program& program, const Options& options, const ReliefOptions& relief,
                 const std::vector<std::unique_ptr<Shape>>& shapes, const Context& context) {
  Scene scene{shapes[0]->georef(), shapes[0]->extent(), relief, 0};
  for (std::size_t k = 1; k < shapes.size(); ++k) {
    check_same_crs(scene.georef, options.inputs[0], shapes[k]->georef(), options.inputs[k]);
    const Extent other = moved(shapes[k]->extent(), shapes[k]->georef(), scene.georef);
    scene.extent = {{std::min(scene.extent.low.x, other.low.x), std::min(scene.extent.low.y, other.low.y)},
                    {std::max(scene.extent.high.x, other.high.x), std::max(scene.extent.high.y, other.high.y)}};
  }
  const Window probe = fit_window(scene.georef, scene.extent, kProbe, kProbe);
  const Range range = height_range(shapes[0]->source, probe, context);
  scene.relief.low = range.low;
  scene.relief.high = range.high;
  scene.base = range.low - 0.1 * (range.high - range.low);
  if (options.exaggeration) {
    scene.relief.exaggeration = *options.exaggeration;
  } else {
    scene.relief.exaggeration = good_exaggeration(shapes[0]->source, probe, context);
    program.say(fmt::format("--exaggeration {:.4g} (chosen, as none was given)", scene.relief.exaggeration));
  }
  return scene;
}

Layout make_layout(const Options& options, const Scene& scene, int panels) {
  const int lines = !options.captions ? 0 : options.error.empty() ? 2 : 3;
  // From the side a square block looks wider than it is high.
  const double plan = scene.extent.height() > 0 ? scene.extent.width() / scene.extent.height() : 1;
  const double aspect = options.view == kViews[1] ? 1.5 : std::clamp(plan, 0.1, 10.0);
  if (!options.size.empty()) {
    const auto [width, height] = parse_size("--size", options.size);
    return fit_layout(panels, width, height, aspect, lines);
  }
  const int width = static_cast<int>(std::lround(kPanelPixels * std::min(1.0, aspect)));
  const int height = static_cast<int>(std::lround(kPanelPixels / std::max(1.0, aspect)));
  return grow_layout(panels, width, height, lines);
}

Image draw(const Options& options, const Scene& scene, const Layout& layout, const ReliefOptions& relief,
           const FieldSource& source, const FieldSource& color, const Context& context) {
  if (options.view == kViews[0])
    return shade_relief(source, fit_window(scene.georef, scene.extent, layout.width, layout.height), relief, color,
                        context);
  PerspectiveOptions perspective;
  perspective.relief = relief;
  perspective.elevation = options.elevation;
  perspective.base = scene.base;
  if (options.from) perspective.from = *options.from;
  return draw_perspective(source, scene.georef, scene.extent, layout.width, layout.height, perspective, color, context);
}

bool holds_panels(const std::string& path) {
  if (!is_model_file(path) || is_tiled_model(path)) return false;
  return !std::holds_alternative<Terrain>(load_model(path));
}

/// The panels as one picture, and what is said of it: its size, then `facts`.
void write_sheet(const Program& program, const Options& options, const Layout& layout, std::vector<Panel> panels,
                 const nlohmann::ordered_json& facts, const Context& context) {
  const std::size_t count = panels.size();
  const Image sheet = compose(layout, std::move(panels), context);
  write_png(sheet, options.output, program.overwrite, context);
  nlohmann::ordered_json json = {{"width", sheet.width}, {"height", sheet.height}, {"panels", count}};
  for (const auto& [key, value] : facts.items()) json[key] = value;
  json["bytes"] = std::filesystem::file_size(options.output);
  if (program.json) return program.print(json);
  program.say(fmt::format("{}: {} x {} pixels", options.output, sheet.width, sheet.height));
}

/// Only models in space: TetraQuad surfaces, by ray casting, and patches.
void run_in_space(const Program& program, const Options& options) {
  const Context context = program.context();
  const auto count = static_cast<int>(options.inputs.size());
  const int lines = options.captions ? 2 : 0;
  Layout layout = grow_layout(count, kPanelPixels, kPanelPixels, lines);
  if (!options.size.empty()) {
    const auto [width, height] = parse_size("--size", options.size);
    layout = fit_layout(count, width, height, 1, lines);
  }
  const double pixels = kPixelDrawn * layout.sheet_width * layout.sheet_height;
  std::vector<Panel> panels;
  for (const std::string& path : options.inputs) {
    Model model = load_any_model(path);
    const std::string name = std::filesystem::path(path).filename().string();
    Panel panel;
    std::string words;
    if (const auto* surface = std::get_if<TetraQuad>(&model)) {
      check_tetraquad_need("drawing", *surface, kTetrahedronDrawn, pixels, path);
      panel.picture = draw_panel(*surface, options.tetraquad, options.from, options.elevation, layout.width,
                                 layout.height, context);
      words = kind_text(*surface);
    } else if (const auto* set = std::get_if<PatchSet>(&model)) {
      check_patches_need("drawing", set->patches, kPatchDrawn * static_cast<double>(set->patches.size()) + pixels,
                         path);
      panel.picture =
          draw_patch_panel(*set, options.style, options.from, options.elevation, layout.width, layout.height, context);
      words = kind_text(*set);
    } else {
      throw UsageError(fmt::format("'{}' is a terrain: terrains are drawn among themselves", path), path);
    }
    if (options.captions) panel.caption = {name, words};
    panels.push_back(std::move(panel));
  }
  write_sheet(program, options, layout, std::move(panels), {}, context);
}

void run(const Program& program, const Options& options) {
  const ReliefOptions relief = parse_relief(options);
  choose("--view", options.view, kViews);
  if (!options.size.empty()) parse_size("--size", options.size);
  std::vector<std::string> files = options.inputs;
  if (!options.error.empty()) files.push_back(options.error);
  check_output(program, options.output, {".png"}, files);
  parse_patch_style("--style", options.style);
  if (holds_panels(options.inputs.front())) return run_in_space(program, options);
  const Context context = program.context();
  std::vector<std::unique_ptr<Shape>> shapes;
  for (const std::string& path : options.inputs) shapes.push_back(load_shape(program, options, path, context));
  const Scene scene = make_scene(program, options, relief, shapes, context);
  const std::unique_ptr<Shape> truth =
      options.error.empty() ? nullptr : load_shape(program, options, options.error, context);
  double largest = 0;
  if (truth) {
    check_same_crs(scene.georef, options.inputs[0], truth->georef(), options.error);
    const Window probe = fit_window(scene.georef, scene.extent, kProbe, kProbe);
    for (const auto& shape : shapes) {
      const Range range = height_range(difference_of(shape->source, truth->source), probe, context);
      largest = std::max({largest, std::abs(range.low), std::abs(range.high)});
    }
  }
  const Layout layout = make_layout(options, scene, static_cast<int>(shapes.size()));
  std::vector<Panel> panels;
  for (const auto& shape : shapes) {
    context.check();
    Panel panel;
    ReliefOptions own = scene.relief;
    FieldSource color;
    if (truth) {
      own.ramp = ColorRamp::diverging;
      own.low = -largest;
      own.high = largest;
      color = difference_of(shape->source, truth->source);
      shape->caption.push_back(fmt::format("blue {0:.3g} below to red {0:.3g} above", largest));
    }
    panel.picture = draw(options, scene, layout, own, shape->source, color, context);
    if (options.captions) panel.caption = shape->caption;
    panels.push_back(std::move(panel));
  }
  write_sheet(program, options, layout, std::move(panels),
              {{"view", options.view}, {"exaggeration", scene.relief.exaggeration}}, context);
}

}  // namespace

void add_render(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, program, "render", "Grids and models as a picture, side by side",
                                  "retalho render dem.tif dem.retalho -o picture.png\n"
                                  "retalho render dem.retalho -o block.png --view perspective --size 1600x1000\n"
                                  "retalho render flat.retalho smooth.retalho -o errors.png --error dem.tif\n"
                                  "retalho render scan.retalho -o scan.png --up y --from 30 --cut 'x<0.2'");
  command->add_option("FILE", options->inputs, "Models (.retalho; tiled: the folder) and elevation grids")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", options->output, "The picture, ending in .png")->required()->type_name("FILE");
  command->add_option("--size", options->size, "Of the whole picture, pixels")->type_name("WxH");
  command->add_option("--view", options->view, "plan (default) or perspective")->type_name("KIND");
  command->add_option("--exaggeration", options->exaggeration, "Vertical exaggeration (default: one that reads well)")
      ->type_name("Z");
  command->add_option("--light", options->light, "Where the light comes from: degrees from north, and over the horizon")
      ->type_name("AZ,ALT");
  command->add_option("--colors", options->colors, "hypsometric (default) or gray")->type_name("KIND");
  command->add_option("--error", options->error, "Colour by the height above (red) or below (blue) this grid")
      ->type_name("DEM");
  command->add_option("--from", options->from, "Perspective: where the eye stands, degrees from north (default 200)")
      ->type_name("AZ");
  command->add_option("--elevation", options->elevation, "Perspective: the eye's degrees over the horizon (default 35)")
      ->type_name("ALT");
  command->add_flag("!--no-captions", options->captions, "No words under the pictures");
  add_grid_flags(*command, options->grid);
  add_tile_memory_flag(*command, options->tile_memory);
  command->add_option("--style", options->style, "Patches: shaded, lines (default), isophotes, zebra, gaussian, mean")
      ->type_name("KIND");
  add_tetraquad_flags(*command, options->tetraquad);
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
