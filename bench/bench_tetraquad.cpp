// TetraQuad surfaces: errors both ways, CPU time and memory of fits, and rays against Embree on triangles.
//   bench_tetraquad                      the whole table
//   bench_tetraquad --case CASE          one case of it
//   bench_tetraquad --value CASE:WHAT    CASE: torus8, torus16, bunny24, bunny32, bunny48, noise02, noise05, adaptive,
//                                        bumps (bumps:gain: coefficients of a grid over the adaptive mesh's); all but
//                                        bumps with -cg or -local behind them for the other ways to fit
//                                        closed24, closed48, closed-adaptive: open edges of all closed scans together;
//                                        closed-others: of the leg and the building, 24, 48 and adaptive together;
//                                        tenmillion: a torus of 10^7 points at 32
//                                        poisson: CGAL's reconstruction of the bunny with its defaults beside the fit
//                                        at 24 (poisson:ratio), with a mesh four times as fine beside the fit at 32
//                                        (poisson:fine_ratio); distances of all to triangles
//                                        WHAT: mean, max, normal, back (surface to truth, largest), coefficients, cpu,
//                                        memory, open
//                                        or rays:camera, rays:random, rays:camera_ratio, rays:random_ratio, rays:misses
// Errors are fractions of the bounding box's diagonal; truth is the torus itself, or bunny_check.ply (points that the
// fit has not seen). One thread.
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <nanoflann.hpp>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "peers/poisson.h"
#include "retalho/cloud/cloud.h"
#include "retalho/cloud/normals.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/tetraquad/adaptive.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/rays.h"
#include "support.h"

using namespace retalho;

namespace {

std::string data(const std::string& name) {
  return (bench::data_folder() / "points" / name).string();
}

double cpu_now() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}
double peak_megabytes() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return static_cast<double>(u.ru_maxrss) / 1024;
}
Context one_thread() {
  Context context;
  context.threads = 1;
  return context;
}

constexpr double kRing = 0.35, kTube = 0.15;

PointCloud torus(std::size_t count, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  PointCloud cloud;
  while (cloud.positions.size() < count) {
    const double u = angle(engine), v = angle(engine), ring = kRing + kTube * std::cos(v);
    if (angle(engine) / (2 * std::numbers::pi) * (kRing + kTube) > ring) continue;
    cloud.positions.push_back({ring * std::cos(u), ring * std::sin(u), kTube * std::sin(v)});
    cloud.normals.push_back({std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)});
  }
  return cloud;
}

double diagonal(const PointCloud& cloud) {
  const PointSummary box = summarize(cloud);
  return norm(box.maximum - box.minimum);
}

/// Distance to a dense cloud of oriented points: to the tangent plane of the nearest, or to it where that is nearer.
class NearestPlane {
 public:
  explicit NearestPlane(const PointCloud& cloud) : cloud_(cloud), tree_(3, *this, {16}) {}
  double operator()(Vec3 p) const {
    std::uint32_t index = 0;
    double distance2 = 0;
    const std::array<double, 3> at = {p.x, p.y, p.z};
    tree_.knnSearch(at.data(), 1, &index, &distance2);
    // Beyond twice the clouds' spacing the plane says nothing.
    const double plane = std::abs(dot(p - cloud_.positions[index], normalized(cloud_.normals[index])));
    return std::sqrt(distance2) > 0.01 * diagonal(cloud_) ? std::sqrt(distance2) : plane;
  }
  std::size_t kdtree_get_point_count() const { return cloud_.positions.size(); }
  double kdtree_get_pt(std::size_t k, std::size_t axis) const {
    const Vec3& p = cloud_.positions[k];
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

 private:
  const PointCloud& cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, NearestPlane>, NearestPlane, 3,
                                      std::uint32_t>
      tree_;
};

using Values = std::map<std::string, double>;

Values measure(const PointCloud& cloud, const PointCloud& truth, const TetraQuadFitOptions& options,
               const std::function<double(Vec3)>& distance, std::size_t adaptive = 0) {
  Values values;
  const double start = cpu_now(), size = diagonal(truth);
  TetraQuadFitReport report;
  const TetraQuad surface =
      adaptive > 0 ? fit_tetraquad_adaptive(cloud, {.coefficients = adaptive}, options, &report, one_thread())
                   : fit_tetraquad(cloud, options, &report, one_thread());
  values["cpu"] = cpu_now() - start;
  values["memory"] = peak_megabytes();
  values["iterations"] = report.iterations;
  values["coefficients"] = static_cast<double>(report.coefficients);
  const TetraQuadField field(surface);
  double sum = 0, largest = 0, angle = 0;
  std::size_t found = 0;
  for (std::size_t k = 0; k < truth.positions.size(); ++k) {
    const auto foot = field.project(truth.positions[k]);
    if (!foot) continue;
    ++found;
    const double d = norm(foot->point - truth.positions[k]);
    sum += d;
    largest = std::max(largest, d);
    const Vec3 n = normalized(truth.normals[k]);
    angle += std::atan2(norm(cross(foot->normal, n)), dot(foot->normal, n));
  }
  values["mean"] = sum / static_cast<double>(found) / size;
  values["max"] = largest / size;
  values["normal"] = angle / static_cast<double>(found) * 180 / std::numbers::pi;
  values["lost"] = static_cast<double>(truth.positions.size() - found);
  const TriangleMesh mesh = mesh_tetraquad(field);
  double back = 0, back_mean = 0;
  for (const Vec3& p : mesh.positions) {
    const double d = distance(p) / size;
    back = std::max(back, d);
    back_mean += d / static_cast<double>(mesh.positions.size());
  }
  values["back"] = back;
  values["back_mean"] = back_mean;
  const MeshTopology topology = topology_of(mesh);
  values["open"] = static_cast<double>(topology.open_edges);
  values["components"] = static_cast<double>(topology.components);
  values["genus"] = static_cast<double>(topology.genus);
  values["triangles"] = static_cast<double>(mesh.triangles.size());
  return values;
}

PointCloud noisy(PointCloud cloud, double sigma) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal(0, sigma * diagonal(cloud));
  for (Vec3& p : cloud.positions) p = p + Vec3{normal(engine), normal(engine), normal(engine)};
  return cloud;
}

/// A sphere with six bumps of widths 0.02 to 0.12 radii, as high as half their width: smooth and sharp places mixed.
/// r(d) = 0.4 + sum w/2 exp(-0.16 |d - c|^2 / w^2) over the six unit vectors c of the axes.
PointCloud bumps(std::size_t count, unsigned seed) {
  const std::array<Vec3, 6> centres = {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  PointCloud cloud;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 d = normalized(Vec3{normal(engine), normal(engine), normal(engine)});
    double r = 0.4;
    Vec3 slope{};
    for (std::size_t i = 0; i < 6; ++i) {
      const double w = 0.02 * static_cast<double>(i + 1), narrow = 0.16 / (w * w);
      const double height = w / 2 * std::exp(-narrow * norm2(d - centres[i]));
      r += height;
      slope = slope - 2 * narrow * height * (d - centres[i]);
    }
    cloud.positions.push_back(r * d);
    cloud.normals.push_back(normalized(d - (slope - dot(slope, d) * d) / r));
  }
  return cloud;
}

/// How many times the coefficients of the adaptive mesh a grid takes for the adaptive mesh's error (its order between
/// resolutions 24 and 32 continued).
Values run_bumps() {
  const PointCloud cloud = bumps(60000, 1), truth = bumps(20000, 2);
  const NearestPlane distance(cloud);
  const auto to_truth = [&](Vec3 p) { return distance(p); };
  const TetraQuadFitOptions light = {.smoothness = 0.1};
  Values values = measure(cloud, truth, light, to_truth, 22000);
  Values coarse = measure(cloud, truth, {.resolution = 24, .smoothness = 0.1}, to_truth);
  Values fine = measure(cloud, truth, {.resolution = 32, .smoothness = 0.1}, to_truth);
  const double order =
      std::log(coarse["mean"] / fine["mean"]) / std::log(fine["coefficients"] / coarse["coefficients"]);
  values["grid24_mean"] = coarse["mean"];
  values["grid24_coefficients"] = coarse["coefficients"];
  values["grid32_mean"] = fine["mean"];
  values["grid32_coefficients"] = fine["coefficients"];
  values["gain"] = fine["coefficients"] * std::pow(fine["mean"] / values["mean"], 1 / order) / values["coefficients"];
  return values;
}

/// Distances to triangles, both ways, as fractions of the diagonal.
void compare(Values& values, const std::string& name, const TriangleMesh& mesh, const PointCloud& truth,
             const NearestPlane& to_truth) {
  const bench::MeshDistance surface(mesh);
  const double size = diagonal(truth);
  double sum = 0, largest = 0, angle = 0, back = 0;
  for (std::size_t k = 0; k < truth.positions.size(); ++k) {
    const auto foot = surface.foot(truth.positions[k]);
    const double d = norm(foot.point - truth.positions[k]);
    sum += d;
    largest = std::max(largest, d);
    const Vec3 n = normalized(truth.normals[k]);
    angle += std::atan2(norm(cross(foot.normal, n)), dot(foot.normal, n));
  }
  for (const Vec3& p : mesh.positions) back += to_truth(p);
  const auto count = static_cast<double>(truth.positions.size());
  values[name + "_mean"] = sum / count / size;
  values[name + "_max"] = largest / size;
  values[name + "_normal"] = angle / count * 180 / std::numbers::pi;
  values[name + "_back_mean"] = back / static_cast<double>(mesh.positions.size()) / size;
  values[name + "_triangles"] = static_cast<double>(mesh.triangles.size());
  values[name + "_open"] = static_cast<double>(topology_of(mesh).open_edges);
}

Values run_poisson() {
  const PointCloud bunny = read_points(data("bunny.ply")), truth = read_points(data("bunny_check.ply"));
  const NearestPlane to_truth(bunny);
  Values values;
  double start = 0;
  for (const int resolution : {24, 32}) {
    const std::string name = resolution == 24 ? "ours" : "ours32";
    start = cpu_now();
    const TetraQuad surface =
        fit_tetraquad(bunny, {.resolution = resolution, .solver = TetraQuadSolver::cg}, nullptr, one_thread());
    values[name + "_cpu"] = cpu_now() - start;
    compare(values, name, mesh_tetraquad(TetraQuadField(surface), {.divisions = 6}, nullptr, one_thread()), truth,
            to_truth);
  }
  for (const int fineness : {1, 4}) {
    const std::string name = fineness == 1 ? "cgal" : "cgal_fine";
    start = cpu_now();
    const TriangleMesh mesh = bench::poisson_by_cgal(bunny, fineness);
    values[name + "_cpu"] = cpu_now() - start;
    compare(values, name, mesh, truth, to_truth);
  }
  values["ratio"] = values["ours_mean"] / values["cgal_mean"];
  values["fine_ratio"] = values["ours32_mean"] / values["cgal_fine_mean"];
  return values;
}

/// Scans by `closed`: open edges of all together, on grids or (0) an adaptive mesh. Oni's 1,435 points are too few for
/// a grid of 48.
Values run_closed(const std::vector<int>& resolutions, const std::vector<std::string>& names) {
  Values values;
  for (const std::string& name : names) {
    PointCloud cloud = read_points(data(name));
    if (cloud.normals.empty()) cloud.normals = estimate_normals(cloud.positions, {}, nullptr, one_thread());
    for (const int resolution : resolutions) {
      if (name == "oni.xyz" && resolution == 48) continue;
      const TetraQuadFitOptions options = {.resolution = std::max(2, resolution),
                                           .smoothness = resolution == 0 ? 0.1 : 1.0,
                                           .closed = true,
                                           .solver = TetraQuadSolver::cg};
      const TetraQuad surface =
          resolution == 0 ? fit_tetraquad_adaptive(cloud, {.coefficients = 29900}, options, nullptr, one_thread())
                          : fit_tetraquad(cloud, options, nullptr, one_thread());
      values["open"] += static_cast<double>(topology_of(mesh_tetraquad(TetraQuadField(surface))).open_edges);
      values["scans"] += 1;
    }
  }
  return values;
}

/// Ten million points of the torus, at 32.
Values run_ten_million() {
  const PointCloud cloud = torus(10000000, 1);
  Values values = measure(cloud, torus(20000, 2), {.resolution = 32, .solver = TetraQuadSolver::cg},
                          [](Vec3 p) { return std::abs(std::hypot(std::hypot(p.x, p.y) - kRing, p.z) - kTube); });
  values["cloud_memory"] =
      static_cast<double>(cloud.positions.capacity() + cloud.normals.capacity()) * sizeof(Vec3) / (1 << 20);
  return values;
}

Values run_case(const std::string& whole_name) {
  const std::vector<std::string> closed = {"bunny.ply",      "hand.xyz",     "elephant.xyz",           "oni.xyz",
                                           "rocker_arm.ply", "gargoyle.ply", "armadillo_nonormals.ply"};
  if (whole_name == "closed24" || whole_name == "closed48")
    return run_closed({whole_name == "closed24" ? 24 : 48}, closed);
  if (whole_name == "closed-adaptive") return run_closed({0}, closed);
  if (whole_name == "closed-others") return run_closed({24, 48, 0}, {"scanned_leg.ply", "building.ply"});
  if (whole_name == "tenmillion") return run_ten_million();
  if (whole_name == "bumps") return run_bumps();
  if (whole_name == "poisson") return run_poisson();
  const std::size_t dash = whole_name.find('-');
  const std::string name = whole_name.substr(0, dash), way = dash == std::string::npos ? "" : whole_name.substr(dash);
  const TetraQuadSolver solver = way == "-cg"      ? TetraQuadSolver::cg
                                 : way == "-local" ? TetraQuadSolver::local
                                                   : TetraQuadSolver::cholesky;
  if (name == "torus8" || name == "torus16") {
    const auto distance = [](Vec3 p) { return std::abs(std::hypot(std::hypot(p.x, p.y) - kRing, p.z) - kTube); };
    return measure(torus(40000, 1), torus(20000, 2), {.resolution = name == "torus8" ? 8 : 16, .solver = solver},
                   distance);
  }
  const PointCloud bunny = read_points(data("bunny.ply")), truth = read_points(data("bunny_check.ply"));
  const NearestPlane distance(bunny);
  const auto to_truth = [&](Vec3 p) { return distance(p); };
  if (name == "adaptive") return measure(bunny, truth, {.smoothness = 0.1, .solver = solver}, to_truth, 29900);
  if (name == "noise02") return measure(noisy(bunny, 0.002), truth, {.resolution = 24, .solver = solver}, to_truth);
  if (name == "noise05") return measure(noisy(bunny, 0.005), truth, {.resolution = 24, .solver = solver}, to_truth);
  const int resolution = name == "bunny48" ? 48 : name == "bunny32" ? 32 : 24;
  return measure(bunny, truth, {.resolution = resolution, .solver = solver}, to_truth);
}

// --- rays ------------------------------------------------------------------------------------------------------------

struct Ray {
  Vec3 origin, direction;
};

/// Four views of 512 x 512, framed by the box.
std::vector<Ray> camera_rays(Vec3 middle, double radius) {
  std::vector<Ray> rays;
  for (int view = 0; view < 4; ++view) {
    const double a = view * std::numbers::pi / 2 + 0.3;
    const Vec3 eye = middle + radius * Vec3{3 * std::cos(a), 0.7, 3 * std::sin(a)};
    const Vec3 ahead = normalized(middle - eye), right = normalized(Vec3{-ahead.z, 0, ahead.x}),
               up = cross(right, ahead);
    for (int y = 0; y < 512; ++y)
      for (int x = 0; x < 512; ++x)
        rays.push_back({eye, ahead + ((x + 0.5) / 512 - 0.5) * 0.6 * right + ((y + 0.5) / 512 - 0.5) * 0.6 * up});
  }
  return rays;
}

std::vector<Ray> random_chords(Vec3 middle, double radius) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto on_sphere = [&] {
    const double z = 2 * unit(engine) - 1, a = 2 * std::numbers::pi * unit(engine), r = std::sqrt(1 - z * z);
    return middle + radius * Vec3{r * std::cos(a), r * std::sin(a), z};
  };
  std::vector<Ray> rays(1000000);
  for (Ray& ray : rays) {
    ray.origin = on_sphere();
    ray.direction = on_sphere() - ray.origin;
  }
  return rays;
}

/// Millions of rays a second, the best of three runs.
double speed(const std::vector<Ray>& rays, const std::function<bool(const Ray&)>& cast, double* share) {
  double best = 1e300;
  std::size_t hits = 0;
  for (int run = 0; run < 3; ++run) {
    const double start = cpu_now();
    hits = 0;
    for (const Ray& ray : rays) hits += cast(ray) ? 1 : 0;
    best = std::min(best, cpu_now() - start);
  }
  *share = static_cast<double>(hits) / static_cast<double>(rays.size());
  return static_cast<double>(rays.size()) / best / 1e6;
}

class Triangles {
 public:
  explicit Triangles(const TriangleMesh& mesh) {
    device_ = rtcNewDevice("threads=1");
    scene_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* at = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (const Vec3& p : mesh.positions)
      for (const double c : {p.x, p.y, p.z}) *at++ = static_cast<float>(c);
    auto* index = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t v : t) *index++ = v;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~Triangles() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Triangles(const Triangles&) = delete;
  Triangles& operator=(const Triangles&) = delete;

  bool cast(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit r{};
    r.ray.org_x = static_cast<float>(ray.origin.x);
    r.ray.org_y = static_cast<float>(ray.origin.y);
    r.ray.org_z = static_cast<float>(ray.origin.z);
    r.ray.dir_x = static_cast<float>(ray.direction.x);
    r.ray.dir_y = static_cast<float>(ray.direction.y);
    r.ray.dir_z = static_cast<float>(ray.direction.z);
    r.ray.tfar = HUGE_VALF;
    r.ray.mask = ~0U;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &r);
    return r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

/// Three million rays from inside of a closed torus: how many leave it.
double count_misses() {
  const TetraQuad surface = fit_tetraquad(torus(40000, 1), {.resolution = 16}, nullptr, one_thread());
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field, 9, one_thread());
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  std::size_t misses = 0;
  for (int n = 0; n < 3000000; ++n) {
    const double u = angle(engine), v = angle(engine), r = 0.9 * kTube * angle(engine) / (2 * std::numbers::pi);
    const double ring = kRing + r * std::cos(v);
    const Vec3 origin = {ring * std::cos(u), ring * std::sin(u), r * std::sin(v)};
    misses += rays.first(origin, {normal(engine), normal(engine), normal(engine)}) ? 0 : 1;
  }
  return static_cast<double>(misses);
}

Values run_rays() {
  const PointCloud bunny = read_points(data("bunny.ply"));
  const PointSummary box = summarize(bunny);
  const Vec3 middle = 0.5 * (box.minimum + box.maximum);
  const double radius = 0.5 * norm(box.maximum - box.minimum);
  const TetraQuad surface = fit_tetraquad(bunny, {.resolution = 24}, nullptr, one_thread());
  const TetraQuadField field(surface);
  const double start = cpu_now();
  const TetraQuadRays rays(field, 9, one_thread());
  Values values;
  values["build"] = cpu_now() - start;
  values["prims"] = static_cast<double>(rays.size());
  const TriangleMesh mesh = mesh_tetraquad(field, {.divisions = 3}, nullptr, one_thread());
  values["triangles"] = static_cast<double>(mesh.triangles.size());
  const Triangles triangles(mesh);
  for (const bool is_camera : {true, false}) {
    const std::vector<Ray> all = is_camera ? camera_rays(middle, radius) : random_chords(middle, radius);
    const std::string name = is_camera ? "camera" : "random";
    double share = 0, triangle_share = 0;
    const double ours = speed(
        all, [&](const Ray& r) { return rays.first(r.origin, r.direction).has_value(); }, &share);
    const double peer = speed(
        all, [&](const Ray& r) { return triangles.cast(r); }, &triangle_share);
    values[name] = ours;
    values[name + "_triangles"] = peer;
    values[name + "_ratio"] = ours / peer;
    values[name + "_hits"] = share;
    values[name + "_hits_triangles"] = triangle_share;
  }
  return values;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string wanted = argc > 2 && std::string(argv[1]) == "--value" ? argv[2] : "";
  if (!wanted.empty()) {
    const std::string name = wanted.substr(0, wanted.find(':')), what = wanted.substr(wanted.find(':') + 1);
    const double value =
        wanted == "rays:misses" ? count_misses() : (name == "rays" ? run_rays() : run_case(name)).at(what);
    fmt::print("{{\"value\": {:.6g}}}\n", value);
    return 0;
  }
  std::vector<std::string> names = {
      "torus8",     "torus16",    "bunny24",       "bunny32",         "bunny48",       "noise02",     "noise05",
      "bunny24-cg", "bunny48-cg", "torus16-local", "bunny24-local",   "adaptive",      "adaptive-cg", "bumps",
      "poisson",    "closed24",   "closed48",      "closed-adaptive", "closed-others", "tenmillion",  "rays"};
  if (argc > 2 && std::string(argv[1]) == "--case") names = {argv[2]};
  for (const std::string& name : names) {
    fmt::print("{}\n", name);
    for (const auto& [what, value] : name == "rays" ? run_rays() : run_case(name))
      fmt::print("  {:<24}{:.6g}\n", what, value);
  }
  if (names.size() > 1) fmt::print("rays that leave a closed torus, of 3 million: {}\n", count_misses());
  return 0;
}
