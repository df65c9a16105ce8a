#include "patch_calls.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "patch_desk.h"
#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/mesh/patch_mesh.h"
#include "retalho/model/model.h"
#include "retalho/patch/joins.h"
#include "retalho/patch/report.h"
#include "retalho/patch/transfinite.h"
#include "saved_file.h"

namespace retalho::viewer {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begun) {
  return std::chrono::duration<double>(Clock::now() - begun).count();
}

struct Drawn {
  std::vector<float> position, normal, parameters, value;
  std::vector<std::uint32_t> index;
};

/// One more patch. What a vertex is coloured by: "error": the distance from the exact transfinite surface, "gaussian",
/// "mean".
void draw(const Patch& patch, const PatchSurface& surface, const std::string& colour, const Context& context,
          Drawn& out) {
  const Domain& domain = patch.domain;
  const std::size_t n = domain.parameters.size(), first = out.parameters.size() / 2;
  out.position.resize(3 * (first + n));
  out.normal.resize(3 * (first + n));
  out.parameters.resize(2 * (first + n));
  out.value.resize(colour == "none" ? 0 : first + n);
  parallel_chunks(n, 256, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 uv = domain.parameters[i];
      const Vec3 p = surface.point(uv), normal = surface.shading_normal(uv);
      const double place[3] = {p.x, p.y, p.z}, up[3] = {normal.x, normal.y, normal.z};
      const std::size_t v = first + i;
      for (std::size_t k = 0; k < 3; ++k) {
        out.position[3 * v + k] = static_cast<float>(place[k]);
        out.normal[3 * v + k] = static_cast<float>(up[k]);
      }
      out.parameters[2 * v] = static_cast<float>(uv.x);
      out.parameters[2 * v + 1] = static_cast<float>(uv.y);
      if (colour == "error") out.value[v] = static_cast<float>(norm(p - transfinite_point(patch.sides, uv)));
      if (colour == "gaussian" || colour == "mean") {
        const PatchCurvature c = surface.curvature(uv);
        out.value[v] = static_cast<float>(colour == "mean" ? c.mean : c.gaussian);
      }
    }
  });
  for (const auto& t : domain.triangles)
    for (const std::uint32_t v : t) out.index.push_back(static_cast<std::uint32_t>(first) + v);
}

/// The sums and the worst of all patches, as `retalho patch` says them.
void add_report(Json& words, const PatchDesk::State& state) {
  PatchReport all;
  for (std::size_t i = 0; i < state.patches.size(); ++i) {
    const PatchReport report = assess(state.patches[i], state.surfaces[i]);
    all.boundary_gap = std::max(all.boundary_gap, report.boundary_gap);
    all.gradient_jump = std::max(all.gradient_jump, report.gradient_jump);
    all.folds.folds += report.folds.folds;
    all.turned += report.turned;
  }
  words["boundary_gap"] = all.boundary_gap;
  words["gradient_jump"] = all.gradient_jump;
  words["folds"] = all.folds.folds;
  words["turned"] = all.turned;
  Json joins = Json::array();
  for (const PatchJoin& join : find_joins(state.patches, state.surfaces))
    joins.push_back({{"patches", {join.first, join.second}},
                     {"watertight", join.watertight},
                     {"angle", join.degrees},
                     {"kind", join.g1 ? "G1" : "G0"}});
  words["joins"] = std::move(joins);
}

Answer compute_call(PatchDesk& desk, const Json& input, const Context& context) {
  const Clock::time_point begun = Clock::now();
  const bool dragging = flag_or(input, "dragging", false);
  const std::string colour = word(input, "colour", {"none", "error", "gaussian", "mean"});
  return desk.with(input, dragging, context, [&](const PatchDesk::State& state) {
    Drawn drawn;
    std::vector<float> sides;
    Json names = Json::array(), first_triangles = Json::array();
    std::size_t nodes = 0, triangles = 0;
    bool flat = true;
    for (std::size_t i = 0; i < state.patches.size(); ++i) {
      const Patch& patch = state.patches[i];
      names.push_back(patch.name);
      first_triangles.push_back(drawn.index.size() / 3);
      draw(state.drawn[i], state.surfaces[i], colour, context, drawn);
      nodes += patch.positions.size();
      triangles += patch.domain.triangles.size();
      flat = flat && patch.recovery == Recovery::barycentric;
      for (const SideCurve& side : patch.sides)
        for (std::size_t k = 0; k <= 64; ++k) {
          const Vec3 p = side.node(k, 64);
          for (const double v : {p.x, p.y, p.z}) sides.push_back(static_cast<float>(v));
        }
    }
    Json words = {{"nodes", nodes},
                  {"triangles", triangles},
                  {"seconds", seconds_since(begun)},
                  {"patches", names},
                  {"first_triangles", first_triangles},
                  {"flat", flat}};
    if (!dragging) add_report(words, state);
    Answer answer{
        words,
        {make_array("position", drawn.position), make_array("normal", drawn.normal),
         make_array("parameters", drawn.parameters), make_array("index", drawn.index), make_array("sides", sides)}};
    if (!drawn.value.empty()) answer.arrays.push_back(make_array("value", drawn.value));
    return answer;
  });
}

Answer at_call(PatchDesk& desk, const Json& input, const Context& context) {
  const Vec2 uv{number(input, "u", -1, 2), number(input, "v", -1, 2)};
  return desk.with(input, true, context, [&](const PatchDesk::State& state) {
    const auto k = static_cast<std::size_t>(
        input.contains("patch") ? whole(input, "patch", 0, static_cast<std::int64_t>(state.patches.size()) - 1) : 0);
    const PatchJet jet = state.surfaces[k].full_jet(uv);
    const PatchCurvature curvature = state.surfaces[k].curvature(uv);
    const auto place = [](Vec3 p) { return Json{p.x, p.y, p.z}; };
    return Answer{{{"point", place(jet.point)},
                   {"normal", place(jet.normal)},
                   {"gaussian", curvature.gaussian},
                   {"mean", curvature.mean},
                   {"inside", jet.inside}}};
  });
}

/// The triangles that are drawn, as a file (sides that two patches share are joined); or the model.
Answer save_call(PatchDesk& desk, const Json& input, const Context& context) {
  const std::string format = save_format(input);
  return desk.with(input, false, context, [&](const PatchDesk::State& state) {
    if (format == "retalho") return saved_model(encode_model(PatchSet{state.patches}));
    std::vector<Patch> drawn;
    for (std::size_t i = 0; i < state.patches.size(); ++i)
      drawn.push_back(refine(state.patches[i], state.surfaces[i], state.factors[i]));
    return saved_mesh(mesh_patches(drawn), format);
  });
}

}  // namespace

void add_patch_calls(CallTable& table, const InputFiles& inputs) {
  const auto desk = std::make_shared<PatchDesk>(inputs);
  const auto bound = [desk](auto call) {
    return [desk, call](const Json& input, const Context& context) { return call(*desk, input, context); };
  };
  table["/api/patches/files"] = {
      Call::Kind::quick, bound([](PatchDesk& d, const Json&, const Context&) {
        Json list = Json::array();
        for (const PatchInput& one : d.inputs())
          list.push_back({{"name", one.name}, {"described", one.described}, {"document", one.document}});
        return Answer{{{"files", list}}};
      })};
  table["/api/patches/compute"] = {Call::Kind::quick, bound(compute_call)};
  table["/api/patches/at"] = {Call::Kind::quick, bound(at_call)};
  table["/api/patches/save"] = {Call::Kind::slow, bound(save_call)};
}

}  // namespace retalho::viewer
