#include "patch_calls.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/patch/document.h"
#include "retalho/patch/joins.h"
#include "retalho/patch/patch.h"
#include "retalho/patch/report.h"
#include "retalho/patch/surface.h"
#include "retalho/patch/transfinite.h"

namespace retalho::viewer {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kDrawnSide = 48;  // a patch of few divisions is drawn with about this many pieces a side

double seconds_since(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

struct Wanted {
  std::size_t divisions = 0;
  Recovery recovery = Recovery::smooth;
  friend bool operator==(const Wanted&, const Wanted&) = default;
};

Wanted wanted_of(const Json& input) {
  Wanted wanted;
  wanted.divisions = static_cast<std::size_t>(whole(input, "divisions", 1, 256));
  const std::string recovery = word(input, "recovery", {"barycentric", "spr", "smooth"});
  wanted.recovery = recovery == "barycentric" ? Recovery::barycentric
                    : recovery == "spr"       ? Recovery::spr
                                              : Recovery::smooth;
  return wanted;
}

PatchSides sides_of(const Json& input, bool dragging) {
  const auto at = input.find("document");
  if (at == input.end()) throw BadInput("the call lacks 'document'", {}, "document");
  const std::vector<PatchSpec> specs = parse_patches(at->dump());
  if (specs.empty()) throw BadInput("the document holds no patch", {}, "document");
  // While a curve is dragged its crossings are not looked for: the last call of a drag does.
  return join_sides(specs.front().sides, {.crossings = !dragging}, specs.front().where);
}

/// The patch of the last call: a dragged curve moves it, and only other divisions or another recovery make it anew.
class PatchDesk {
 public:
  struct State {
    Wanted wanted;
    Patch patch;
    PatchSurface surface;
    Patch drawn;  // the same domain, cut finer where the divisions are few
  };

  /// Calls `use` with the patch of `sides`; no other call may use it meanwhile.
  template <class Use>
  auto with(const PatchSides& sides, const Wanted& wanted, const Context& context, Use&& use) {
    const std::lock_guard lock(mutex_);
    if (state_ && state_->wanted == wanted) {
      State& s = *state_;
      state_usable_ = false;
      move_sides(s.patch, sides);
      s.surface.move(s.patch, context);
      state_usable_ = true;
    } else {
      state_.reset();
      const std::size_t n = wanted.divisions;
      Patch patch = make_patch(sides, {.divisions = {n, n, n}, .recovery = wanted.recovery}, context);
      PatchSurface surface(patch, context);
      const std::size_t factor = wanted.recovery == Recovery::barycentric ? 1 : (kDrawnSide + n - 1) / n;
      Patch drawn = refine(patch, surface, factor);
      state_ = std::make_unique<State>(State{wanted, std::move(patch), std::move(surface), std::move(drawn)});
      state_usable_ = true;
    }
    return use(static_cast<const State&>(*state_));
  }

  /// After an exception in the middle of a move the patch is made anew.
  void repair() {
    const std::lock_guard lock(mutex_);
    if (!state_usable_) state_.reset();
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<State> state_;
  bool state_usable_ = false;
};

struct Drawn {
  std::vector<float> position, normal, parameters, value;
  std::vector<std::uint32_t> index;
};

/// What a vertex is coloured by: "error": the distance from the exact transfinite surface, "gaussian", "mean".
Drawn draw(const PatchDesk::State& state, const PatchSides& sides, const std::string& colour, const Context& context) {
  const Domain& domain = state.drawn.domain;
  const std::size_t n = domain.parameters.size();
  Drawn out;
  out.position.resize(3 * n);
  out.normal.resize(3 * n);
  out.parameters.resize(2 * n);
  out.value.resize(colour == "none" ? 0 : n);
  parallel_chunks(n, 256, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 uv = domain.parameters[i];
      const Vec3 p = state.surface.point(uv), normal = state.surface.shading_normal(uv);
      const double place[3] = {p.x, p.y, p.z}, up[3] = {normal.x, normal.y, normal.z};
      for (std::size_t k = 0; k < 3; ++k) {
        out.position[3 * i + k] = static_cast<float>(place[k]);
        out.normal[3 * i + k] = static_cast<float>(up[k]);
      }
      out.parameters[2 * i] = static_cast<float>(uv.x);
      out.parameters[2 * i + 1] = static_cast<float>(uv.y);
      if (colour == "error") out.value[i] = static_cast<float>(norm(p - transfinite_point(sides, uv)));
      if (colour == "gaussian" || colour == "mean") {
        const PatchCurvature c = state.surface.curvature(uv);
        out.value[i] = static_cast<float>(colour == "mean" ? c.mean : c.gaussian);
      }
    }
  });
  for (const auto& t : domain.triangles) out.index.insert(out.index.end(), t.begin(), t.end());
  return out;
}

Answer compute_call(PatchDesk& desk, const Json& input, const Context& context) {
  const Clock::time_point begun = Clock::now();
  const bool dragging = flag_or(input, "dragging", false);
  const Wanted wanted = wanted_of(input);
  const std::string colour = word(input, "colour", {"none", "error", "gaussian", "mean"});
  const PatchSides sides = sides_of(input, dragging);
  return desk.with(sides, wanted, context, [&](const PatchDesk::State& state) {
    const Drawn drawn = draw(state, sides, colour, context);
    Json words = {{"nodes", state.patch.positions.size()},
                  {"triangles", state.patch.domain.triangles.size()},
                  {"seconds", seconds_since(begun)}};
    if (!dragging) {
      const PatchReport report = assess(state.patch, state.surface);
      words["boundary_gap"] = report.boundary_gap;
      words["gradient_jump"] = report.gradient_jump;
      words["folds"] = report.folds.folds;
      words["turned"] = report.turned;
    }
    Answer answer{words,
                  {make_array("position", drawn.position), make_array("normal", drawn.normal),
                   make_array("parameters", drawn.parameters), make_array("index", drawn.index)}};
    if (!drawn.value.empty()) answer.arrays.push_back(make_array("value", drawn.value));
    std::vector<float> sides_drawn;
    for (const SideCurve& side : sides)
      for (std::size_t k = 0; k <= 64; ++k) {
        const Vec3 p = side.node(k, 64);
        for (const double v : {p.x, p.y, p.z}) sides_drawn.push_back(static_cast<float>(v));
      }
    answer.arrays.push_back(make_array("sides", sides_drawn));
    return answer;
  });
}

Answer at_call(PatchDesk& desk, const Json& input, const Context& context) {
  const Vec2 uv{number(input, "u", -1, 2), number(input, "v", -1, 2)};
  const PatchSides sides = sides_of(input, true);
  return desk.with(sides, wanted_of(input), context, [&](const PatchDesk::State& state) {
    const PatchJet jet = state.surface.full_jet(uv);
    const PatchCurvature curvature = state.surface.curvature(uv);
    const auto place = [](Vec3 p) { return Json{p.x, p.y, p.z}; };
    return Answer{{{"point", place(jet.point)},
                   {"normal", place(jet.normal)},
                   {"gaussian", curvature.gaussian},
                   {"mean", curvature.mean},
                   {"inside", jet.inside}}};
  });
}

}  // namespace

void add_patch_calls(CallTable& table) {
  const auto desk = std::make_shared<PatchDesk>();
  const auto guarded = [desk](auto call) {
    return [desk, call](const Json& input, const Context& context) {
      try {
        return call(*desk, input, context);
      } catch (...) {
        desk->repair();
        throw;
      }
    };
  };
  table["/api/patches/compute"] = {Call::Kind::quick, guarded(compute_call)};
  table["/api/patches/at"] = {Call::Kind::quick, guarded(at_call)};
}

}  // namespace retalho::viewer
