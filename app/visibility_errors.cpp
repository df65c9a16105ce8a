#include "visibility_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "retalho/core/error.h"
#include "retalho/render/color.h"
#include "retalho/render/image.h"
#include "retalho/visibility/model_map.h"

namespace retalho::app {
namespace {

/// "clough-tocher quadratic" to "clough-tocher-quadratic"; of a file, its name alone.
std::string file_name(const std::string& name) {
  std::string text = std::filesystem::path(name).stem().string();
  for (char& c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '-';
  return text;
}

}  // namespace

void add_visibility_flags(CLI::App& command, VisibilityFlags& flags) {
  command.add_option("--visibility", flags.radius,
                     "Compare intervisibility maps too: cells seen within this radius (0: no limit)");
  command.add_option("--visibility-maps", flags.maps, "Folder for pictures of each map less the grid's own");
  command.add_option("--directions", flags.directions, "Azimuths of the maps")->capture_default_str();
  command.add_option("--observer-height", flags.observer_height, "Eye above the ground, for the maps")
      ->capture_default_str();
  command.add_option("--target-height", flags.target_height, "Targets above the ground, for the maps")
      ->capture_default_str();
}

VisibilityErrors::VisibilityErrors(const Program& program, const VisibilityFlags& flags, const Raster& raster,
                                   const Context& context)
    : program_(program), flags_(flags), raster_(raster) {
  if (!std::isfinite(*flags.radius) || *flags.radius < 0)
    throw UsageError(fmt::format("--visibility {}: give a radius of 0 (no limit) or more", *flags.radius), {},
                     "--visibility");
  options_ = {flags.directions, flags.observer_height, flags.target_height, *flags.radius};
  own_ = intervisibility_map(raster, options_, context);
}

void VisibilityErrors::add(const Terrain& terrain, const std::string& name, const Context& context) {
  std::vector<float> map = model_intervisibility(terrain, raster_, options_, context);
  differences_.push_back(compare_maps(map, own_));
  if (!flags_.maps.empty()) {
    for (std::size_t i = 0; i < map.size(); ++i) map[i] -= own_[i];
    maps_.emplace_back(file_name(name), std::move(map));
  }
}

void VisibilityErrors::write_pictures() const {
  if (flags_.maps.empty()) return;
  std::error_code failed;
  std::filesystem::create_directories(flags_.maps, failed);
  if (failed)
    throw CannotWrite(fmt::format("cannot make the folder '{}': {}", flags_.maps, failed.message()), flags_.maps);
  // The scale ends at the 99th percentile of all differences: a few cells would else leave the others white.
  std::vector<float> sizes;
  for (const auto& [name, map] : maps_)
    for (const float v : map)
      if (!std::isnan(v)) sizes.push_back(std::abs(v));
  if (sizes.empty()) return;
  const auto nth = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 99 / 100);
  std::nth_element(sizes.begin(), nth, sizes.end());
  const double scale = std::max(static_cast<double>(*nth), 1.0);
  for (const auto& [name, map] : maps_) {
    Image image(raster_.columns, raster_.rows, {128, 128, 128});
    for (std::size_t i = 0; i < map.size(); ++i)
      if (!std::isnan(map[i]))
        image.pixels[i] = to_rgb(ramp_color(ColorRamp::diverging, 0.5 + 0.5 * static_cast<double>(map[i]) / scale));
    write_png(image, (std::filesystem::path(flags_.maps) / (name + ".png")).string(), program_.overwrite);
  }
  program_.say(
      fmt::format("{}: {} pictures; blue sees {:.4g} cells too few or less, red as many too many, gray is void",
                  flags_.maps, maps_.size(), scale));
}

}  // namespace retalho::app
