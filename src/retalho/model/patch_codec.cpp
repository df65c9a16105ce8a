#include "retalho/model/patch_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/model/check.h"
#include "retalho/model/codec_parts.h"

namespace retalho {
namespace {

namespace fb = model_file;
using Builder = flatbuffers::FlatBufferBuilder;

bool finite(Vec3 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

template <typename Values, typename Get>
flatbuffers::Offset<fb::Numbers> add_reals(Builder& builder, const Values& values, Get get) {
  std::vector<double> list;
  list.reserve(values.size());
  for (const auto& value : values) list.push_back(get(value));
  return add_numbers(builder, pack_reals(list));
}

template <typename Values>
flatbuffers::Offset<fb::Numbers> add_integers(Builder& builder, const Values& values) {
  return add_numbers(builder, pack_integers(std::vector<std::int64_t>(values.begin(), values.end())));
}

/// x, y, z as one list after the other.
std::array<flatbuffers::Offset<fb::Numbers>, 3> add_points(Builder& builder, const std::vector<Vec3>& points) {
  return {add_reals(builder, points, [](Vec3 p) { return p.x; }),
          add_reals(builder, points, [](Vec3 p) { return p.y; }),
          add_reals(builder, points, [](Vec3 p) { return p.z; })};
}

std::vector<Vec3> read_points(const fb::Numbers* x, const fb::Numbers* y, const fb::Numbers* z, std::uint64_t count,
                              const char* what) {
  const std::vector<double> xs = unpack_reals(view(x, what), count, what),
                            ys = unpack_reals(view(y, what), count, what),
                            zs = unpack_reals(view(z, what), count, what);
  std::vector<Vec3> points(xs.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {xs[i], ys[i], zs[i]};
  return points;
}

/// Indices under `end`.
std::vector<std::uint32_t> read_indices(const fb::Numbers* numbers, std::uint64_t count, std::uint64_t end,
                                        const char* what) {
  const std::vector<std::int64_t> values = unpack_integers(view(numbers, what), count, what);
  std::vector<std::uint32_t> indices;
  indices.reserve(values.size());
  for (const std::int64_t value : values) {
    if (value < 0 || static_cast<std::uint64_t>(value) >= end)
      throw CannotRead(fmt::format("an index is {}, of {}", value, end), {}, what);
    indices.push_back(static_cast<std::uint32_t>(value));
  }
  return indices;
}

flatbuffers::Offset<fb::PatchSide> encode_side(Builder& builder, const SideCurve& side,
                                               const std::vector<std::uint32_t>& nodes) {
  const Curve& curve = side.curve();
  const auto points = add_points(builder, curve.points);
  flatbuffers::Offset<fb::Numbers> weights;
  if (curve.rational()) weights = add_numbers(builder, pack_reals(curve.weights));
  const auto first = add_integers(builder, curve.first);
  const auto breaks = add_numbers(builder, pack_reals(curve.breaks));
  const auto node_list = add_integers(builder, nodes);
  fb::PatchSideBuilder table(builder);
  table.add_dimension(static_cast<std::uint8_t>(curve.dimension));
  table.add_closed(curve.closed);
  table.add_reversed(side.reversed());
  table.add_placement(static_cast<fb::PatchPlacement>(side.placement()));
  table.add_points(curve.points.size());
  table.add_x(points[0]);
  table.add_y(points[1]);
  table.add_z(points[2]);
  if (!weights.IsNull()) table.add_weights(weights);
  table.add_segments(curve.segment_count());
  table.add_first(first);
  table.add_breaks(breaks);
  table.add_nodes(nodes.size());
  table.add_node_list(node_list);
  return table.Finish();
}

std::string curve_fault(const Curve& curve) {
  if (curve.dimension != 2 && curve.dimension != 3) return "a curve is neither plane nor in space";
  if (curve.empty() || curve.first.front() != 0 || curve.first.back() != curve.points.size() ||
      curve.breaks.size() != curve.first.size())
    return "a curve's segments do not fit its points";
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    if (curve.first[i + 1] <= curve.first[i] || curve.first[i + 1] - curve.first[i] > kMaxCurveDegree + 1)
      return "a curve's segment has no degree from 0 to 63";
    if (!(curve.breaks[i] < curve.breaks[i + 1])) return "a curve's parameters do not ascend";
  }
  if (!std::isfinite(curve.breaks.front()) || !std::isfinite(curve.breaks.back())) return "a parameter is not finite";
  if (!std::all_of(curve.points.begin(), curve.points.end(), finite)) return "a control point is not finite";
  if (curve.rational() && curve.weights.size() != curve.points.size()) return "not one weight a control point";
  for (const double w : curve.weights)
    if (!(w > 0) || !std::isfinite(w)) return "a weight is not positive";
  return {};
}

SideCurve decode_side(const fb::PatchSide& table, std::uint64_t vertices, std::vector<std::uint32_t>& nodes) {
  Curve curve;
  curve.dimension = table.dimension();
  curve.closed = table.closed();
  curve.points = read_points(table.x(), table.y(), table.z(), table.points(), "side points");
  if (table.weights()) curve.weights = unpack_reals(view(table.weights(), "weights"), table.points(), "weights");
  if (table.segments() >= (std::uint64_t{1} << 31)) throw CannotRead("too many segments", {}, "segments");
  curve.first = read_indices(table.first(), table.segments() + 1, curve.points.size() + 1, "first");
  curve.breaks = unpack_reals(view(table.breaks(), "breaks"), table.segments() + 1, "breaks");
  nodes = read_indices(table.node_list(), table.nodes(), vertices, "node_list");
  if (const std::string fault = curve_fault(curve); !fault.empty()) throw CannotRead("no patch: " + fault, {}, "sides");
  if (table.placement() > fb::PatchPlacement::MAX) throw CannotRead("an unknown placement", {}, "placement");
  return SideCurve(std::move(curve), table.reversed(), static_cast<SidePlacement>(table.placement()));
}

flatbuffers::Offset<fb::PatchTable> encode_patch(Builder& builder, const Patch& patch) {
  const Domain& domain = patch.domain;
  const auto name = builder.CreateString(patch.name);
  std::vector<flatbuffers::Offset<fb::PatchSide>> sides;
  for (std::size_t s = 0; s < 3; ++s) sides.push_back(encode_side(builder, patch.sides[s], domain.sides[s]));
  const auto side_list = builder.CreateVector(sides);
  const auto u = add_reals(builder, domain.parameters, [](Vec2 p) { return p.x; });
  const auto v = add_reals(builder, domain.parameters, [](Vec2 p) { return p.y; });
  const auto points = add_points(builder, patch.positions);
  std::array<flatbuffers::Offset<fb::Numbers>, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<std::int64_t> values;
    values.reserve(domain.triangles.size());
    for (const auto& t : domain.triangles)
      values.push_back(k == 0 ? std::int64_t{t[0]} : std::int64_t{t[k]} - std::int64_t{t[0]});
    corners[k] = add_numbers(builder, pack_integers(values));
  }
  fb::PatchTableBuilder table(builder);
  table.add_name(name);
  table.add_recovery(static_cast<fb::PatchRecovery>(patch.recovery));
  table.add_sides(side_list);
  table.add_vertices(domain.parameters.size());
  table.add_triangles(domain.triangles.size());
  table.add_u(u);
  table.add_v(v);
  table.add_x(points[0]);
  table.add_y(points[1]);
  table.add_z(points[2]);
  table.add_corner_a(corners[0]);
  table.add_corner_b(corners[1]);
  table.add_corner_c(corners[2]);
  return table.Finish();
}

Patch decode_patch(const fb::PatchTable& table) {
  Patch patch;
  Domain& domain = patch.domain;
  if (table.vertices() >= 0xffffffffU || table.triangles() >= 0xffffffffU / 3)
    throw CannotRead("more vertices or triangles than 32 bits can number", {}, "vertices");
  if (table.name()) patch.name = table.name()->str();
  if (table.recovery() > fb::PatchRecovery::MAX) throw CannotRead("an unknown recovery", {}, "recovery");
  patch.recovery = static_cast<Recovery>(table.recovery());
  if (!table.sides() || table.sides()->size() != 3) throw CannotRead("a patch without three sides", {}, "sides");
  for (std::uint32_t s = 0; s < 3; ++s)
    patch.sides[s] = decode_side(*table.sides()->Get(s), table.vertices(), domain.sides[s]);
  const std::vector<double> u = unpack_reals(view(table.u(), "u"), table.vertices(), "u"),
                            v = unpack_reals(view(table.v(), "v"), table.vertices(), "v");
  for (std::size_t i = 0; i < u.size(); ++i) domain.parameters.push_back({u[i], v[i]});
  patch.positions = read_points(table.x(), table.y(), table.z(), table.vertices(), "positions");
  constexpr std::array<const char*, 3> kNames = {"corner_a", "corner_b", "corner_c"};
  const std::array<const fb::Numbers*, 3> parts = {table.corner_a(), table.corner_b(), table.corner_c()};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<std::int64_t> values = unpack_integers(view(parts[k], kNames[k]), table.triangles(), kNames[k]);
    domain.triangles.resize(values.size());
    for (std::size_t t = 0; t < values.size(); ++t) {
      const std::uint64_t index = static_cast<std::uint64_t>(values[t]) + (k == 0 ? 0 : domain.triangles[t][0]);
      if (index >= table.vertices())
        throw CannotRead(fmt::format("triangle {} names vertex {} of {}", t, index, table.vertices()), {}, kNames[k]);
      domain.triangles[t][k] = static_cast<std::uint32_t>(index);
    }
  }
  return patch;
}

std::string side_fault(const Patch& patch, std::size_t s, double size) {
  const auto& nodes = patch.domain.sides[s];
  const int side = static_cast<int>(s);
  if (nodes.size() < 2) return "a side has no edge";
  if (patch.sides[s].curve().empty()) return "a side is a function, not a curve";
  if (const std::string fault = curve_fault(patch.sides[s].curve()); !fault.empty()) return fault;
  double before = -1;
  for (const std::uint32_t v : nodes) {
    if (v >= patch.domain.parameters.size()) return "a side names a node that is not there";
    const Vec2 p = patch.domain.parameters[v];
    if (!(side == 0 ? p.x + p.y == 1 : side == 1 ? p.x == 0 : p.y == 0)) return "a node of a side is not on it";
    const double at = side_argument(side, p);
    if (!(at > before)) return "the nodes of a side are out of order";
    before = at;
    if (!(norm(patch.sides[s].point(at) - patch.positions[v]) <= 1e-6 * size)) return "a side does not pass its nodes";
  }
  if (side_argument(side, patch.domain.parameters[nodes.front()]) != 0 || before != 1)
    return "a side does not run from corner to corner";
  return {};
}

std::string patch_fault(const Patch& patch) {
  const Domain& domain = patch.domain;
  if (domain.triangles.empty()) return "it has no triangles";
  if (patch.positions.size() != domain.parameters.size()) return "not one position a node";
  if (!std::all_of(patch.positions.begin(), patch.positions.end(), finite)) return "a position is not finite";
  for (const Vec2& p : domain.parameters)
    if (!(p.x >= 0 && p.y >= 0 && p.x + p.y <= 1)) return "a node is outside of the parameter triangle";
  double area = 0;
  for (const auto& t : domain.triangles) {
    for (const std::uint32_t v : t)
      if (v >= domain.parameters.size()) return "a triangle names a node that is not there";
    const Vec2 a = domain.parameters[t[0]], b = domain.parameters[t[1]], c = domain.parameters[t[2]];
    const double twice = cross(b - a, c - a);
    if (!(twice > 0)) return "a triangle is turned over in the parameters";
    area += twice;
  }
  if (!(std::abs(area - 1) < 1e-9)) return "the triangles do not cover the parameter triangle once";
  const double size = control_size(patch.positions);
  for (std::size_t s = 0; s < 3; ++s)
    if (const std::string fault = side_fault(patch, s, size); !fault.empty()) return fault;
  return {};
}

}  // namespace

std::string find_fault(const PatchSet& set) {
  if (set.patches.empty()) return "there is no patch";
  for (std::size_t i = 0; i < set.patches.size(); ++i)
    if (const std::string fault = patch_fault(set.patches[i]); !fault.empty())
      return fmt::format("patch {}: {}", i, fault);
  return {};
}

flatbuffers::Offset<fb::PatchSetSurface> encode_patches(Builder& builder, const PatchSet& set, bool checked) {
  if (checked)
    if (const std::string fault = find_fault(set); !fault.empty())
      throw BadInput("these patches cannot be saved: " + fault);
  std::vector<flatbuffers::Offset<fb::PatchTable>> patches;
  for (const Patch& patch : set.patches) patches.push_back(encode_patch(builder, patch));
  const auto list = builder.CreateVector(patches);
  fb::PatchSetSurfaceBuilder table(builder);
  table.add_patches(list);
  return table.Finish();
}

PatchSet decode_patches(const fb::PatchSetSurface& table) {
  PatchSet set;
  if (table.patches())
    for (const fb::PatchTable* patch : *table.patches()) set.patches.push_back(decode_patch(*patch));
  if (const std::string fault = find_fault(set); !fault.empty())
    throw CannotRead("no patches: " + fault, {}, "surface");
  return set;
}

}  // namespace retalho
