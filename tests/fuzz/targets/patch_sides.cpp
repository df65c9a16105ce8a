// Three arbitrary curves: whatever they do, the patch is refused with words, or it is a mesh that holds together and a
// surface that has a value everywhere.
#include "retalho/patch/sides.h"

#include <cmath>
#include <cstring>
#include <vector>

#include "retalho/patch/patch.h"
#include "retalho/patch/report.h"
#include "retalho/patch/surface.h"
#include "target.h"

namespace {

using namespace retalho;

/// Numbers out of bytes: small ones in general, at times huge, tiny, equal, or none at all.
struct Numbers {
  const std::uint8_t* data;
  std::size_t size, at = 0;
  std::uint8_t byte() { return at < size ? data[at++] : 0; }
  double number() {
    const std::uint8_t kind = byte();
    const double v = static_cast<double>(byte()) - 128;
    if (kind < 240) return v / 16;
    if (kind < 244) return std::ldexp(v, 900);
    if (kind < 248) return std::ldexp(v, -900);
    if (kind < 252) return 5e6 + v / 100;
    return kind == 252 ? std::nan("") : kind == 253 ? INFINITY : 0;
  }
  Vec3 point() {
    const double x = number(), y = number();
    return {x, y, byte() % 2 == 0 ? 0 : number()};
  }
};

SideCurve side_of(Numbers& numbers, Vec3 from, Vec3 to) {
  const int kind = numbers.byte() % 8;
  const int degree = 1 + kind % 4;
  std::vector<Vec3> points{from};
  for (int k = 1; k < degree; ++k) points.push_back(numbers.point());
  points.push_back(numbers.byte() % 16 == 0 ? numbers.point() : to);  // at times it does not meet
  std::vector<double> weights;
  if (kind >= 4)
    for (std::size_t k = 0; k < points.size(); ++k) weights.push_back(1 + numbers.byte() % 8);
  return SideCurve(make_bezier(points, degree, 3, weights), numbers.byte() % 8 == 0,
                   numbers.byte() % 2 == 0 ? SidePlacement::parameter : SidePlacement::arc_length);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::refuse_or([&] {
    Numbers numbers{data, size};
    const Vec3 u = numbers.point(), v = numbers.point(), w = numbers.point();
    const PatchSides sides =
        join_sides({side_of(numbers, u, v), side_of(numbers, v, w), side_of(numbers, w, u)}, {}, "patch 1");
    PatchOptions options;
    for (std::size_t& n : options.divisions) n = 1 + numbers.byte() % 6;
    options.layout = numbers.byte() % 2 == 0 ? DomainLayout::delaunay : DomainLayout::midpoint;
    options.recovery = static_cast<Recovery>(numbers.byte() % 3);
    const Patch patch = make_patch(sides, options);
    fuzz::require(patch.positions.size() == patch.domain.parameters.size(), "a node without a place");
    for (const auto& t : patch.domain.triangles)
      for (const std::uint32_t corner : t) fuzz::require(corner < patch.positions.size(), "a corner that is not there");
    for (const Vec3 p : patch.positions)
      fuzz::require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "a node that is nowhere");
    const PatchSurface surface(patch);
    const Vec3 p = surface.point({1.0 / 3, 1.0 / 3});
    fuzz::require(!std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z), "a surface without a value in its middle");
  });
}
