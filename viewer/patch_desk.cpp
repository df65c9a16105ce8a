#include "patch_desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "patch_calls.h"
#include "retalho/core/error.h"
#include "retalho/patch/document.h"
#include "retalho/patch/joins.h"

namespace retalho::viewer {
namespace {

constexpr std::size_t kDrawnSide = 48;  // a patch of few divisions is drawn with about this many pieces a side

std::vector<PatchSides> sides_of(const Json& input, bool dragging) {
  const auto at = input.find("document");
  if (at == input.end()) throw BadInput("the call lacks 'document'", {}, "document");
  const std::vector<PatchSpec> specs = parse_patches(at->dump());
  if (specs.size() > kMostPatches)
    throw BadInput(fmt::format("the page shows at most {} patches, the document has {}", kMostPatches, specs.size()));
  std::vector<PatchSides> sides;
  sides.reserve(specs.size());
  for (const PatchSpec& spec : specs) sides.push_back(join_sides(spec.sides, {.crossings = !dragging}, spec.where));
  return sides;
}

PatchDesk::Wanted wanted_of(const Json& input, std::size_t patches) {
  const auto n = static_cast<std::size_t>(whole(input, "divisions", 1, 256));
  if (patches * n * n > kMostPatchTriangles)
    throw BadInput(fmt::format("{} patches of {} divisions are more than {} triangles: choose fewer divisions", patches,
                               n, kMostPatchTriangles),
                   {}, "divisions");
  const std::string recovery = word(input, "recovery", {"barycentric", "spr", "smooth"});
  return {-1, n, patches,
          recovery == "barycentric" ? Recovery::barycentric
          : recovery == "spr"       ? Recovery::spr
                                    : Recovery::smooth};
}

/// Surfaces, and what is drawn, of the patches.
std::unique_ptr<PatchDesk::State> make_state(const PatchDesk::Wanted& wanted, std::vector<Patch> patches,
                                             const Context& context) {
  auto state = std::make_unique<PatchDesk::State>();
  state->wanted = wanted;
  state->patches = std::move(patches);
  for (const Patch& patch : state->patches) {
    context.check();
    state->surfaces.emplace_back(patch, context);
    std::size_t n = 1;
    for (const auto& side : patch.domain.sides) n = std::max(n, side.size() - 1);
    const std::size_t factor = patch.recovery == Recovery::barycentric ? 1 : (kDrawnSide + n - 1) / n;
    state->factors.push_back(factor);
    state->drawn.push_back(refine(patch, state->surfaces.back(), factor));
  }
  return state;
}

}  // namespace

void PatchDesk::prepare(const Json& input, bool dragging, const Context& context) {
  if (input.contains("model")) {
    const auto k = static_cast<int>(whole(input, "model", 0, static_cast<std::int64_t>(inputs_.size()) - 1));
    const PatchInput& file = inputs_[static_cast<std::size_t>(k)];
    if (!file.model) throw BadInput("this file holds curves and no model", {}, "model");
    const Wanted wanted{k, 0, file.model->patches.size(), Recovery::smooth};
    if (!state_ || state_->wanted != wanted) state_ = make_state(wanted, file.model->patches, context);
    return;
  }
  const std::vector<PatchSides> sides = sides_of(input, dragging);
  const Wanted wanted = wanted_of(input, sides.size());
  if (!state_ || state_->wanted != wanted) {
    state_.reset();
    std::vector<Patch> patches;
    patches.reserve(sides.size());
    const std::size_t n = wanted.divisions;
    for (const PatchSides& one : sides)
      patches.push_back(make_patch(one, {.divisions = {n, n, n}, .recovery = wanted.recovery}, context));
    state_ = make_state(wanted, std::move(patches), context);
    return;
  }
  // After an exception in the middle of a move the patches are made anew.
  std::unique_ptr<State> moved = std::exchange(state_, nullptr);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    move_sides(moved->patches[i], sides[i]);
    moved->surfaces[i].move(moved->patches[i], context);
  }
  state_ = std::move(moved);
}

}  // namespace retalho::viewer
