// The class TiledModel: a tiled model that is read by its tiles.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "retalho/tiles/reader.h"

namespace retalho::python {

class TiledModel {
 public:
  TiledModel(std::string folder, std::size_t bound)
      : folder_(std::move(folder)), bound_(bound), reader_(std::make_unique<TileReader>(folder_, bound)) {}
  const std::string& folder() const { return folder_; }
  std::size_t bound() const { return bound_; }
  TileReader& reader() const { return *reader_; }
  const TiledIndex& index() const { return reader_->index(); }

 private:
  std::string folder_;
  std::size_t bound_;
  std::unique_ptr<TileReader> reader_;
};

/// Needs the classes Grid, Terrain, Contours, ErrorReport and TileEntry.
void add_tiled_model(pybind11::module_& module);

}  // namespace retalho::python
