// The strong flat surface beside a smooth model: what a flat triangulation reaches with as many numbers, and with as
// many bytes (`compare --baselines`).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "retalho/model/comparison.h"

namespace retalho {

/// A model to be compared with: its name, numbers and bytes, and how it is written.
struct Rival {
  std::string name;
  std::size_t numbers = 0, bytes = 0;
  bool compact = false;  ///< bytes of the compact form
};

/// Four flat surfaces: the greedy triangulation, and the one that is refined by its own error with heights fitted to
/// every cell and vertices relocated (the strong one), each with the rival's numbers and with the rival's bytes (within
/// a hundredth, where whole vertices allow it), written as the rival is. Of a compact rival the greedy one's heights
/// are fitted while they are rounded. Cost: about five refinements.
std::vector<ModelReport> flat_baselines(const Rival& rival, const Raster& raster, const Context& context = {});

/// Smooth surfaces refined by their own error beside a flat one of `vertices`: at its numbers, and at its bytes.
std::vector<ModelReport> smooth_rivals(std::size_t vertices, const Raster& raster, const Context& context = {});

}  // namespace retalho
