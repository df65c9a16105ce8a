#include "needs_in_space.h"

#include <fmt/format.h>

#include "inputs.h"
#include "needs.h"
#include "retalho/core/memory.h"
#include "retalho/model/model.h"

namespace retalho::app {
namespace {

constexpr double kNodeSmooth = 3700;    // the net of the smooth recovery, on all its levels
constexpr double kNodeRecovered = 750;  // the other recoveries
constexpr double kTileCell = 14;        // a cell of a tile under way; vertices come on top

double a_node(Recovery recovery) {
  return recovery == Recovery::smooth ? kNodeSmooth : kNodeRecovered;
}

}  // namespace

void check_patches_need(const std::string& work, const std::vector<Patch>& patches, double more,
                        const std::string& file) {
  double bytes = kProcessMemory + more, nodes = 0;
  for (const Patch& patch : patches) {
    nodes += static_cast<double>(patch.positions.size());
    bytes += a_node(patch.recovery) * static_cast<double>(patch.positions.size());
  }
  check_memory(bytes, fmt::format("{} patches of {:.0f} nodes", work, nodes), file);
}

void check_nodes_need(const std::string& work, double nodes, Recovery recovery, const std::string& file) {
  check_memory(kProcessMemory + a_node(recovery) * nodes, fmt::format("{} patches of {:.0f} nodes", work, nodes), file);
}

void check_tetraquad_need(const std::string& work, const TetraQuad& surface, double a_tetrahedron, double more,
                          const std::string& file) {
  const auto tets = static_cast<double>(surface.mesh.tets.size());
  check_memory(kProcessMemory + a_tetrahedron * tets + more,
               fmt::format("{} a TetraQuad of {:.0f} tetrahedra", work, tets), file);
}

void check_shown_need(const std::string& file) {
  if (is_model_file(file)) return check_file_need("showing the model", kModelFile, file);
  if (takes_points(file, {})) return check_file_need("showing the points of", kPointFile, file);
  if (file.ends_with(".json")) return;  // curves, patches, quadrics: small, and no grid
  check_grid_need({.work = "showing"}, file, 1);
}

void check_tiles_need(double side, int jobs, const std::string& file) {
  check_memory(kProcessMemory + kTileCell * side * side * jobs,
               fmt::format("making {} tiles at a time, each of {:.0f} x {:.0f} cells", jobs, side, side), file);
}

}  // namespace retalho::app
