#include "retalho/render/color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace retalho {
namespace {

// After "batlow" of F. Crameri (Scientific colour maps, 2018), ten of its stops, raised a fifth of the way to white so
// that shading keeps room below.
constexpr std::array<Rgb, 10> kHypsometric{{{1, 25, 89},
                                            {16, 63, 96},
                                            {28, 90, 98},
                                            {60, 109, 86},
                                            {104, 123, 62},
                                            {157, 137, 43},
                                            {210, 147, 67},
                                            {248, 161, 123},
                                            {253, 183, 188},
                                            {250, 204, 250}}};
constexpr double kRaise = 0.2;
constexpr std::array<Rgb, 1> kGray{{{235, 235, 235}}};
// ColorBrewer's RdBu (C. Brewer, M. Harrower), nine classes, blue first.
constexpr std::array<Rgb, 9> kDiverging{{{33, 102, 172},
                                         {67, 147, 195},
                                         {146, 197, 222},
                                         {209, 229, 240},
                                         {247, 247, 247},
                                         {253, 219, 199},
                                         {244, 165, 130},
                                         {214, 96, 77},
                                         {178, 24, 43}}};

Color from_rgb(Rgb c) {
  return {c.r / 255.0, c.g / 255.0, c.b / 255.0};
}

Color between(std::span<const Rgb> stops, double t) {
  const double clamped = t > 0 ? std::min(t, 1.0) : 0.0;  // NaN: the start
  const double place = clamped * static_cast<double>(stops.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), stops.size() - 1);
  const std::size_t above = std::min(below + 1, stops.size() - 1);
  const double f = place - static_cast<double>(below);
  return (1 - f) * from_rgb(stops[below]) + f * from_rgb(stops[above]);
}

}  // namespace

Color ramp_color(ColorRamp ramp, double t) {
  switch (ramp) {
    case ColorRamp::hypsometric:
      return (1 - kRaise) * between(kHypsometric, t) + kRaise * Color{1, 1, 1};
    case ColorRamp::gray:
      return between(kGray, t);
    case ColorRamp::diverging:
      return between(kDiverging, t);
  }
  return {};
}

Rgb to_rgb(Color color) {
  const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 1.0) * 255)); };
  return {byte(color.r), byte(color.g), byte(color.b)};
}

}  // namespace retalho
