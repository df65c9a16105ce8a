#include "retalho/tin/scattered.h"

#include <fmt/format.h>

#include <algorithm>

#include "retalho/core/error.h"
#include "retalho/tin/predicates.h"
#include "retalho/tin/scattered_mesh.h"
#include "retalho/tin/scattered_places.h"

namespace retalho {
namespace {

/// Moves to the front of `order` three places that are not on one line.
void start_with_area(std::vector<std::uint32_t>& order, const std::vector<Vec2>& at) {
  for (std::size_t k = 2; k < order.size(); ++k)
    if (orientation(at[order[0]], at[order[1]], at[order[k]]) != 0) {
      std::rotate(order.begin() + 2, order.begin() + static_cast<std::ptrdiff_t>(k),
                  order.begin() + static_cast<std::ptrdiff_t>(k) + 1);
      return;
    }
  throw BadInput(fmt::format("all {} places lie on one line: there is no area to triangulate", at.size()));
}

}  // namespace

Tin triangulate_points(std::span<const Vec3> points, ScatteredNotes* notes, const Context& context) {
  ScatteredNotes own;
  const Places places = make_places(points, notes ? *notes : own);
  const std::size_t count = places.at.size();
  if (count < 3) throw BadInput(fmt::format("{} different places: a triangulation needs three", count));
  std::vector<std::uint32_t> order = insertion_order(count);
  start_with_area(order, places.at);
  ScatteredMesh mesh(places.at, order[0], order[1], order[2], count);
  std::uint32_t hint = 0;
  for (std::size_t k = 3; k < count; ++k) {
    if (k % 8192 == 0) {
      context.check();
      context.report("triangulate", static_cast<double>(k) / static_cast<double>(count));
    }
    hint = mesh.insert(order[k], hint);
  }
  return to_tin(mesh, places, {}, count);
}

}  // namespace retalho
