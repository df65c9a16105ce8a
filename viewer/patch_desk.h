// The triangular patches that the page is looking at: made once, moved while a curve is dragged.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "calls.h"
#include "input_files.h"
#include "retalho/patch/surface.h"

namespace retalho::viewer {

/// The patches of the last call: a dragged curve moves them, and only other divisions, another recovery or another
/// number of them makes them anew. Several threads may ask; one is served at a time.
class PatchDesk {
 public:
  /// What the patches were made for.
  struct Wanted {
    int model = -1;  ///< of the command line; -1: a document
    std::size_t divisions = 0, patches = 0;
    Recovery recovery = Recovery::smooth;
    friend bool operator==(const Wanted&, const Wanted&) = default;
  };
  struct State {
    Wanted wanted;
    std::vector<Patch> patches;
    std::vector<PatchSurface> surfaces;
    std::vector<std::size_t> factors;  ///< how many times finer each is drawn, where its divisions are few
    std::vector<Patch> drawn;          ///< cut so; a drag leaves their domains as they are, and their positions behind
  };

  explicit PatchDesk(const InputFiles& inputs) : inputs_(inputs.patches) {}

  const std::vector<PatchInput>& inputs() const { return inputs_; }

  /// Calls `use` with the patches of {"model": k} or {"document", "divisions", "recovery"}. While a curve is dragged
  /// its crossings are not looked for: the last call of a drag does. Throws BadInput as parse_patches and join_sides
  /// do.
  template <class Use>
  auto with(const Json& input, bool dragging, const Context& context, Use&& use) {
    const std::lock_guard lock(mutex_);
    prepare(input, dragging, context);
    return use(static_cast<const State&>(*state_));
  }

 private:
  void prepare(const Json& input, bool dragging, const Context& context);

  std::vector<PatchInput> inputs_;
  std::mutex mutex_;
  std::unique_ptr<State> state_;
};

}  // namespace retalho::viewer
