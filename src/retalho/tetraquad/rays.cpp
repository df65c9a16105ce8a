#include "retalho/tetraquad/rays.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"

namespace retalho {
namespace {

typedef double Pair __attribute__((vector_size(16)));
typedef double Four __attribute__((vector_size(32), aligned(16)));

/// A tetrahedron as a ray meets it, in lattice coordinates about the middle of all.
struct Prim {
  Four axis[3];  ///< gradients of the barycentric coordinates, by axis
  Four offset;   ///< the barycentric coordinates at the middle
  double ordinate[20];
  float low[3], high[3];
  std::uint32_t tet = 0;
};

double value_at(const std::array<double, 4>& b, double s, double* slope) {
  const double r = 1 - s;
  const double p = b[0] * r + b[1] * s, q = b[1] * r + b[2] * s, u = b[2] * r + b[3] * s;
  const double v = p * r + q * s, w = q * r + u * s;
  *slope = 3 * (w - v);
  return v * r + w * s;
}

double bend_at(const std::array<double, 4>& b, double s) {
  return 6 * ((1 - s) * (b[2] - 2 * b[1] + b[0]) + s * (b[3] - 2 * b[2] + b[1]));
}

/// The root between `low` and `high`, where the signs differ (`low_negative`: the one at low).
double bracketed_root(const std::array<double, 4>& b, double low, double high, double f_low, double f_high) {
  const bool low_negative = f_low < 0;
  double s = low + (high - low) * (f_low / (f_low - f_high));
  for (int n = 0; n < 60; ++n) {
    double slope = 0;
    const double f = value_at(b, s, &slope);
    ((f < 0) == low_negative ? low : high) = s;
    double next = s - f / slope;
    if (!(next > low && next < high)) {
      if (f == 0) return s;
      next = 0.5 * (low + high);
    }
    // The step after this one would be about its square times f''/2f': small at a simple root, not where a ray grazes.
    const double step = std::abs(next - s);
    if (step < 1e-10 || (step < 1e-6 && step * step * std::abs(bend_at(b, s)) < 1e-10 * std::abs(slope))) return next;
    s = next;
  }
  return s;
}

/// The box of the parts of a piece whose ordinates do not prove it empty. `corners`: barycentric coordinates.
class TightBox {
 public:
  TightBox(const TetCubic& c, const std::array<Vec3, 4>& x) : c_(c), x_(x) {}

  void add(const std::array<TetBarycentric, 4>& corners, int halvings) {
    if (is_empty(corners)) return;
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i)
      p[i] = corners[i][0] * x_[0] + corners[i][1] * x_[1] + corners[i][2] * x_[2] + corners[i][3] * x_[3];
    if (halvings == 0 || is_inside(p)) {
      for (const Vec3& q : p) {
        low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
        high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
      }
      return;
    }
    std::size_t a = 0, b = 1;
    double longest = -1;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (const double length = norm2(p[i] - p[j]); length > longest * 1.0001) {
          longest = length;
          a = i;
          b = j;
        }
    std::array<TetBarycentric, 4> first = corners, second = corners;
    for (std::size_t k = 0; k < 4; ++k) first[a][k] = second[b][k] = 0.5 * (corners[a][k] + corners[b][k]);
    add(first, halvings - 1);
    add(second, halvings - 1);
  }

  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

 private:
  bool is_inside(const std::array<Vec3, 4>& p) const {
    return std::all_of(p.begin(), p.end(), [&](const Vec3& q) {
      return q.x >= low.x && q.x <= high.x && q.y >= low.y && q.y <= high.y && q.z >= low.z && q.z <= high.z;
    });
  }
  bool is_empty(const std::array<TetBarycentric, 4>& corners) const {
    bool below = false, above = false;
    for (std::size_t i = 0; i < 4; ++i) {
      const TetQuadratic q = contract(c_, corners[i]);
      for (std::size_t j = i; j < 4; ++j) {
        const TetLinear l = contract(q, corners[j]);
        for (std::size_t k = j; k < 4; ++k) {
          const double v = contract(l, corners[k]);
          below = below || v <= 1e-12;
          above = above || v >= -1e-12;
          if (below && above) return false;
        }
      }
    }
    return true;
  }
  const TetCubic& c_;
  const std::array<Vec3, 4>& x_;
};

/// Embree's context with what it does not carry: the ray in double precision and the best hit so far.
struct Query {
  RTCIntersectContext embree;
  double origin[3], direction[3];
  double from, best;
  std::int64_t prim;
};

constexpr double kOverlap = 1e-9;  // segments reach into the next tetrahedron, so that no root falls between two

void intersect(const Prim& prim, std::uint32_t number, Query& query) {
  const Four o =
      prim.offset + prim.axis[0] * query.origin[0] + prim.axis[1] * query.origin[1] + prim.axis[2] * query.origin[2];
  const Four d =
      prim.axis[0] * query.direction[0] + prim.axis[1] * query.direction[1] + prim.axis[2] * query.direction[2];
  // Where the ray passes the planes of the faces; for one that runs along a plane, +-infinity says on which side.
  const Four steady = d + 0.0, at = -o / steady;
  double t0 = query.from, t1 = query.best;
  for (int i = 0; i < 4; ++i) {
    t0 = std::max(t0, steady[i] >= 0 ? at[i] : t0);
    t1 = std::min(t1, steady[i] < 0 ? at[i] : t1);
  }
  const double margin = kOverlap * (1 + std::abs(t1));
  if (!(t0 <= t1 + margin)) return;
  t0 = std::max(query.from, t0 - margin);
  t1 = std::min(query.best, t1 + margin);
  Pair u[4];  // barycentric coordinates where the ray enters and leaves
  for (int i = 0; i < 4; ++i) u[i] = Pair{o[i] + t0 * d[i], o[i] + t1 * d[i]};
  const double* c = prim.ordinate;
  const auto four = [&u](auto a, auto b, auto e, auto f) { return a * u[0] + b * u[1] + e * u[2] + f * u[3]; };
  const Pair q0 = four(c[0], c[1], c[2], c[3]), q1 = four(c[1], c[4], c[5], c[6]), q2 = four(c[2], c[5], c[7], c[8]),
             q3 = four(c[3], c[6], c[8], c[9]), q4 = four(c[4], c[10], c[11], c[12]),
             q5 = four(c[5], c[11], c[13], c[14]), q6 = four(c[6], c[12], c[14], c[15]),
             q7 = four(c[7], c[13], c[16], c[17]), q8 = four(c[8], c[14], c[17], c[18]),
             q9 = four(c[9], c[15], c[18], c[19]);
  const Pair l0 = four(q0, q1, q2, q3), l1 = four(q1, q4, q5, q6), l2 = four(q2, q5, q7, q8), l3 = four(q3, q6, q8, q9);
  const Pair ends = four(l0, l1, l2, l3);
  const auto swapped = [](Pair v) { return Pair{v[1], v[0]}; };
  const Pair inner = l0 * swapped(u[0]) + l1 * swapped(u[1]) + l2 * swapped(u[2]) + l3 * swapped(u[3]);
  const double s = first_root({ends[0], inner[0], inner[1], ends[1]});
  if (s < 0) return;
  const double t = t0 + s * (t1 - t0);
  if (t > query.best || (t == query.best && query.prim >= 0)) return;
  query.best = t;
  query.prim = number;
}

const std::vector<Prim>& prims_of(void* pointer) {
  return *static_cast<const std::vector<Prim>*>(pointer);
}

void bounds_function(const RTCBoundsFunctionArguments* args) {
  const Prim& prim = prims_of(args->geometryUserPtr)[args->primID];
  RTCBounds& box = *args->bounds_o;
  box.lower_x = prim.low[0];
  box.lower_y = prim.low[1];
  box.lower_z = prim.low[2];
  box.upper_x = prim.high[0];
  box.upper_y = prim.high[1];
  box.upper_z = prim.high[2];
}

void intersect_function(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  Query& query = *reinterpret_cast<Query*>(args->context);
  const double before = query.best;
  intersect(prims_of(args->geometryUserPtr)[args->primID], args->primID, query);
  if (query.best < before) {
    RTCRayHit& hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    hit.ray.tfar = std::nextafter(static_cast<float>(query.best), HUGE_VALF);
    hit.hit.geomID = args->geomID;
  }
}

}  // namespace

double first_root(const std::array<double, 4>& b) {
  const bool n0 = b[0] < 0, n1 = b[1] < 0, n2 = b[2] < 0, n3 = b[3] < 0;
  const int changes = (n0 != n1 ? 1 : 0) + (n1 != n2 ? 1 : 0) + (n2 != n3 ? 1 : 0);
  if (changes == 0) return -1;
  if (changes == 1) return bracketed_root(b, 0, 1, b[0], b[3]);
  // Two or three: cut into monotone pieces at the roots of the derivative d0 (1-s)^2 + 2 d1 s (1-s) + d2 s^2.
  const double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
  const double square = d0 - 2 * d1 + d2, half = d1 - d0, root2 = half * half - square * d0;
  std::array<double, 4> cut = {0, 1, 1, 1};
  std::size_t count = 1;
  if (root2 > 0) {
    const double q = -(half + std::copysign(std::sqrt(root2), half));
    double r1 = q != 0 ? d0 / q : 2, r2 = square != 0 ? q / square : 2;
    if (r1 > r2) std::swap(r1, r2);
    if (r1 > 0 && r1 < 1) cut[count++] = r1;
    if (r2 > 0 && r2 < 1) cut[count++] = r2;
  }
  cut[count++] = 1;
  double f_low = b[0];
  for (std::size_t n = 1; n < count; ++n) {
    double slope = 0;
    const double f = n + 1 == count ? b[3] : value_at(b, cut[n], &slope);
    if ((f < 0) != (f_low < 0)) return bracketed_root(b, cut[n - 1], cut[n], f_low, f);
    f_low = f;
  }
  return -1;
}

struct TetraQuadRays::Parts {
  std::vector<Prim> prims;
  Vec3 origin;  ///< of the lattice
  double step = 1;
  Vec3 middle, low, high;  ///< lattice coordinates; the box is about the middle
  const TetraQuadField* field = nullptr;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  double near = 0;  ///< so far from the middle single precision does

  /// The part of the ray in the box of all; false: none.
  bool clip(Vec3 o, Vec3 d, double& enter, double& leave) const {
    const std::array<double, 3> at = {o.x, o.y, o.z}, way = {d.x, d.y, d.z};
    const std::array<double, 3> least = {low.x, low.y, low.z}, most = {high.x, high.y, high.z};
    for (std::size_t k = 0; k < 3; ++k) {
      if (way[k] == 0) {
        if (at[k] < least[k] - 1e-6 || at[k] > most[k] + 1e-6) return false;
        continue;
      }
      const double a = (least[k] - at[k]) / way[k], b = (most[k] - at[k]) / way[k];
      enter = std::max(enter, std::min(a, b) - 1e-6);
      leave = std::min(leave, std::max(a, b) + 1e-6);
    }
    return enter <= leave;
  }

  ~Parts() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

TetraQuadRays::TetraQuadRays(const TetraQuadField& field, int halvings, const Context& context)
    : parts_(std::make_unique<Parts>()) {
  const TetMesh& mesh = field.surface().mesh;
  parts_->field = &field;
  parts_->origin = mesh.origin;
  parts_->step = mesh.step;
  std::vector<std::uint32_t> crossed;
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  const auto corner = [&](std::uint32_t v) {
    const LatticePoint& l = mesh.lattice[v];
    return Vec3{static_cast<double>(l[0]), static_cast<double>(l[1]), static_cast<double>(l[2])};
  };
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    if (!field.may_cross(t)) continue;
    crossed.push_back(t);
    for (const std::uint32_t v : mesh.tets[t]) {
      const Vec3 p = corner(v);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  if (crossed.empty()) low = high = {};
  parts_->middle = 0.5 * (low + high);
  parts_->low = low - parts_->middle;
  parts_->high = high - parts_->middle;
  // What single precision loses along the tree: a few units in the last place of the largest coordinate.
  const double reach = 1 + std::max({parts_->high.x, parts_->high.y, parts_->high.z}), slack = 3e-6 * reach;
  parts_->near = 8 * reach;
  std::vector<Prim> prims(crossed.size());
  std::vector<char> empty(crossed.size(), 0);
  parallel_chunks(crossed.size(), 64, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::uint32_t t = crossed[n];
      std::array<Vec3, 4> x;
      for (std::size_t i = 0; i < 4; ++i) x[i] = corner(mesh.tets[t][i]) - parts_->middle;
      const TetFrame frame(x[0], x[1], x[2], x[3]);
      Prim& prim = prims[n];
      prim.tet = t;
      const TetBarycentric at = frame.barycentric({0, 0, 0});
      for (std::size_t i = 0; i < 4; ++i) {
        prim.axis[0][i] = frame.gradients[i].x;
        prim.axis[1][i] = frame.gradients[i].y;
        prim.axis[2][i] = frame.gradients[i].z;
        prim.offset[i] = at[i];
      }
      const TetCubic& c = field.ordinates(t);
      std::copy(c.begin(), c.end(), prim.ordinate);
      TightBox box(c, x);
      box.add({{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}, std::max(0, halvings));
      empty[n] = box.low.x > box.high.x ? 1 : 0;
      const std::array<double, 3> least = {box.low.x, box.low.y, box.low.z},
                                  most = {box.high.x, box.high.y, box.high.z};
      for (std::size_t k = 0; k < 3; ++k) {
        prim.low[k] = static_cast<float>(least[k] - slack);
        prim.high[k] = static_cast<float>(most[k] + slack);
      }
    }
  });
  for (std::size_t n = 0; n < prims.size(); ++n)
    if (empty[n] == 0) parts_->prims.push_back(prims[n]);

  parts_->device = rtcNewDevice(fmt::format("threads={}", thread_count(context)).c_str());
  if (parts_->device == nullptr) throw Error(Error::Kind::internal, "Embree cannot be started");
  parts_->scene = rtcNewScene(parts_->device);
  rtcSetSceneBuildQuality(parts_->scene, RTC_BUILD_QUALITY_HIGH);
  const RTCGeometry geometry = rtcNewGeometry(parts_->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(parts_->prims.size()));
  rtcSetGeometryUserData(geometry, &parts_->prims);
  rtcSetGeometryBoundsFunction(geometry, bounds_function, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect_function);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(parts_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(parts_->scene);
  if (rtcGetDeviceError(parts_->device) != RTC_ERROR_NONE)
    throw Error(Error::Kind::internal, "Embree cannot build its tree: out of memory?");
}

TetraQuadRays::~TetraQuadRays() = default;
TetraQuadRays::TetraQuadRays(TetraQuadRays&&) noexcept = default;
TetraQuadRays& TetraQuadRays::operator=(TetraQuadRays&&) noexcept = default;

std::size_t TetraQuadRays::size() const {
  return parts_->prims.size();
}

std::optional<TetraQuadRays::Hit> TetraQuadRays::first(Vec3 origin, Vec3 direction, double from, double to) const {
  const Vec3 o = (origin - parts_->origin) / parts_->step - parts_->middle;
  const double length = norm(direction);
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(o.x + o.y + o.z) || parts_->prims.empty()) return {};
  // Along the ray, steps of the grid are counted. From far away, what lies before the box of all is cut off here, since
  // Embree's single precision would lose it.
  const Vec3 d = direction / length;
  const double scale = length / parts_->step;
  double enter = from * scale, leave = to * scale;
  if (std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) > parts_->near && !parts_->clip(o, d, enter, leave))
    return {};
  if (!(enter <= leave)) return {};
  const Vec3 start = o + enter * d;
  Query query;
  rtcInitIntersectContext(&query.embree);
  query.origin[0] = start.x;
  query.origin[1] = start.y;
  query.origin[2] = start.z;
  query.direction[0] = d.x;
  query.direction[1] = d.y;
  query.direction[2] = d.z;
  query.from = 0;
  query.best = leave - enter;
  query.prim = -1;
  RTCRayHit ray;
  ray.ray.org_x = static_cast<float>(start.x);
  ray.ray.org_y = static_cast<float>(start.y);
  ray.ray.org_z = static_cast<float>(start.z);
  ray.ray.dir_x = static_cast<float>(d.x);
  ray.ray.dir_y = static_cast<float>(d.y);
  ray.ray.dir_z = static_cast<float>(d.z);
  ray.ray.tnear = 0;
  ray.ray.tfar = std::nextafter(static_cast<float>(query.best), HUGE_VALF);
  ray.ray.time = 0;
  ray.ray.mask = ~0U;
  ray.ray.id = 0;
  ray.ray.flags = 0;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(parts_->scene, &query.embree, &ray);
  if (query.prim < 0) return {};
  const Prim& prim = parts_->prims[static_cast<std::size_t>(query.prim)];
  Hit hit;
  hit.t = (enter + query.best) / scale;
  hit.tet = prim.tet;
  for (std::size_t i = 0; i < 4; ++i)
    hit.b[i] = prim.offset[i] + prim.axis[0][i] * (start.x + query.best * d.x) +
               prim.axis[1][i] * (start.y + query.best * d.y) + prim.axis[2][i] * (start.z + query.best * d.z);
  return hit;
}

}  // namespace retalho
