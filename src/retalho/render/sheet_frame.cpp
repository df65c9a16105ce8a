#include "retalho/render/sheet_frame.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace retalho {
namespace {

constexpr Rgb kBlack{0, 0, 0};
constexpr double kTick = 1.5, kWords = 2.2;

double round_step(double most) {
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double digit : {5.0, 2.0, 1.0})
    if (digit * power <= most * (1 + 1e-9)) return digit * power;
  return power;
}

/// Degrees in parts that people read: degrees, minutes, seconds.
double angle_step(double most) {
  constexpr std::array<double, 16> kSeconds{36000, 18000, 7200, 3600, 1800, 1200, 600, 300,
                                            120,   60,    30,   20,   10,   5,    2,   1};
  for (const double s : kSeconds)
    if (s / 3600 <= most) return s / 3600;
  return round_step(most * 3600) / 3600;
}

int decimals_of(double step) {
  return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 12);
}

struct UnitName {
  std::string name;
  double factor;  ///< local units in it
};

UnitName bar_unit(const std::string& unit, double length) {
  if (unit == "metre") return length >= 1000 ? UnitName{"km", 1000} : UnitName{"m", 1};
  if (unit.find("foot") != std::string::npos || unit.find("feet") != std::string::npos) return {"ft", 1};
  return {unit == "unit" ? "units" : unit, 1};
}

PageText words_at(Vec2 at, const std::string& text, double angle, double anchor) {
  PageText words;
  words.at = at;
  words.text = text;
  words.size = kWords;
  words.angle = angle;
  words.anchor = anchor;
  return words;
}

}  // namespace

Vec2 SheetMap::place(Vec2 local) const {
  const Vec2 p = exact(local);
  return per_unit > 0 ? Vec2{std::round(p.x * per_unit) / per_unit, std::round(p.y * per_unit) / per_unit} : p;
}

PlanePath line_path(Vec2 a, Vec2 b) {
  return {{PathVerb::move, PathVerb::line}, {a, b}};
}

PlanePath box_path(Vec2 low, Vec2 high) {
  return {{PathVerb::move, PathVerb::line, PathVerb::line, PathVerb::line, PathVerb::close},
          {low, {high.x, low.y}, high, {low.x, high.y}}};
}

std::string coordinate_words(double value, double step, bool geographic, bool east) {
  if (!geographic) {
    const std::string words = fmt::format("{:.{}f}", value, decimals_of(step));
    return words.find_first_not_of("-0.") == std::string::npos ? "0" : words;
  }
  const char* side = value == 0 ? "" : east ? (value > 0 ? "E" : "W") : (value > 0 ? "N" : "S");
  // Whole seconds, or finer where the step is.
  const int digits = decimals_of(std::max(step * 3600, 1e-6));
  const double grain = std::pow(10, digits);
  const double seconds = std::round(std::abs(value) * 3600 * grain) / grain;
  const double degrees = std::floor(seconds / 3600 + 1e-12), rest = seconds - 3600 * degrees;
  const double minutes = std::floor(rest / 60 + 1e-12), left = std::max(0.0, rest - 60 * minutes);
  const bool has_seconds = step * 60 < 1 - 1e-9 || left > 1e-9, has_minutes = has_seconds || step < 1 - 1e-9;
  std::string words = fmt::format("{:.0f}°", degrees);
  if (has_minutes) words += fmt::format("{:02.0f}′", minutes);
  if (has_seconds) words += digits > 0 ? fmt::format("{:.{}f}″", left, digits) : fmt::format("{:02.0f}″", left);
  return words + side;
}

std::vector<double> coordinate_ticks(double low, double high, double most, bool geographic, double& step) {
  step = geographic ? angle_step(most) : round_step(most);
  std::vector<double> ticks;
  const double slack = 1e-9 * step;
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k) ticks.push_back(k * step);
  return ticks;
}

PageGroup draw_frame(const SheetMap& map, const Georef& georef, const TextWidth& width) {
  PageGroup group;
  group.name = "frame";
  group.stroke = kBlack;
  group.width = 0.3;
  group.decoration = true;
  group.paths.push_back({box_path(map.low, map.high), {}});
  const auto local = [&](Vec2 page) {
    return Vec2{map.origin.x + (page.x - map.low.x) / map.scale, map.origin.y - (page.y - map.low.y) / map.scale};
  };
  const Vec2 west_north = georef.to_crs(local(map.low)), east_south = georef.to_crs(local(map.high));
  const Vec2 unit = {map.scale * georef.scale_x, map.scale * georef.scale_y};  // mm a CRS unit
  const auto steps = [&](double low, double high, double per, bool east, const auto& draw) {
    // About 36 mm apart, and never closer than the words are wide.
    double step = 1;
    std::vector<double> ticks;
    for (const double most : {36.0, 54.0, 80.0, 120.0}) {
      ticks = coordinate_ticks(low, high, most / per, georef.geographic, step);
      double widest = 0;
      for (const double t : ticks)
        widest = std::max(widest, kWords * width(coordinate_words(t, step, georef.geographic, east)));
      if (widest + 3 < step * per || ticks.size() < 2) break;
    }
    for (const double t : ticks) draw(t, coordinate_words(t, step, georef.geographic, east));
  };
  steps(west_north.x, east_south.x, unit.x, true, [&](double x, const std::string& words) {
    const double at = map.exact(georef.to_local({x, west_north.y})).x;
    group.paths.push_back({line_path({at, map.low.y}, {at, map.low.y - kTick}), {}});
    group.paths.push_back({line_path({at, map.high.y}, {at, map.high.y + kTick}), {}});
    group.texts.push_back(words_at({at, map.low.y - kTick - 1.6}, words, 0, 0.5));
    group.texts.push_back(words_at({at, map.high.y + kTick + 1.6}, words, 0, 0.5));
  });
  steps(east_south.y, west_north.y, unit.y, false, [&](double y, const std::string& words) {
    const double at = map.exact(georef.to_local({west_north.x, y})).y;
    group.paths.push_back({line_path({map.low.x, at}, {map.low.x - kTick, at}), {}});
    group.paths.push_back({line_path({map.high.x, at}, {map.high.x + kTick, at}), {}});
    // Not at a corner, where words along the other side stand.
    const double half = 0.5 * kWords * width(words) + 1.5;
    if (at - half < map.low.y || at + half > map.high.y) return;
    group.texts.push_back(words_at({map.low.x - kTick - 1.6, at}, words, -90, 0.5));
    group.texts.push_back(words_at({map.high.x + kTick + 1.6, at}, words, -90, 0.5));
  });
  return group;
}

PageGroup draw_scale_bar(const SheetMap& map, const std::string& unit, Vec2 at, double room) {
  const double length = round_step(room / map.scale), on_page = length * map.scale;
  const UnitName name = bar_unit(unit, length);
  constexpr int kParts = 4;
  constexpr double kHeight = 1.3;
  PageGroup group;
  group.name = "scale-bar";
  group.fill = kBlack;
  group.stroke = kBlack;
  group.width = 0.15;
  group.decoration = true;
  for (int k = 0; k < kParts; ++k) {
    const double from = at.x + on_page * k / kParts, to = at.x + on_page * (k + 1) / kParts;
    // Every other part is an outline: its lower and upper stroke.
    if (k % 2 == 0) {
      group.paths.push_back({box_path({from, at.y}, {to, at.y + kHeight}), {}});
    } else {
      group.paths.push_back({line_path({from, at.y}, {to, at.y}), {}});
      group.paths.push_back({line_path({from, at.y + kHeight}, {to, at.y + kHeight}), {}});
      group.paths.push_back({line_path({to, at.y}, {to, at.y + kHeight}), {}});
    }
  }
  const double below = at.y + kHeight + 1.9;
  for (const int k : {0, kParts / 2})
    group.texts.push_back(words_at({at.x + on_page * k / kParts, below},
                                   fmt::format("{:.6g}", length * k / kParts / name.factor), 0, 0.5));
  // The number under its tick, the unit behind it.
  const std::string last = fmt::format("{:.6g}", length / name.factor);
  group.texts.push_back(words_at({at.x + on_page, below}, last, 0, 0.5));
  group.texts.push_back(words_at({at.x + on_page + 2, at.y + 0.5 * kHeight}, name.name, 0, 0));
  return group;
}

std::string scale_words(const SheetMap& map, const std::string& unit) {
  double metres = 0;
  if (unit == "metre") metres = 1;
  if (unit.find("foot") != std::string::npos) metres = unit.find("US") != std::string::npos ? 1200.0 / 3937 : 0.3048;
  if (!(metres > 0)) return {};
  const double ratio = 1000 * metres / map.scale;
  const double grain = std::pow(10, std::floor(std::log10(ratio)) - 2);
  const double rounded = std::round(ratio / grain) * grain;
  const std::string digits = fmt::format("{:.0f}", rounded);
  std::string grouped;  // 63,400
  for (std::size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && (digits.size() - k) % 3 == 0) grouped += ',';
    grouped += digits[k];
  }
  return rounded >= 1 ? fmt::format("about 1 : {}", grouped) : std::string();
}

std::vector<PageGroup> draw_tint_legend(const std::vector<TintStep>& steps, Vec2 at, double room,
                                        const TextWidth& width) {
  constexpr double kHeight = 3;
  std::vector<PageGroup> groups;
  const double each = std::min(9.0, room / static_cast<double>(steps.size()));
  for (std::size_t k = 0; k < steps.size(); ++k) {
    PageGroup box;
    box.name = fmt::format("tint-key-{}", k);
    box.fill = steps[k].color;
    box.stroke = steps[k].color;
    box.width = 0.05;
    box.decoration = true;
    const double x = at.x + static_cast<double>(k) * each;
    box.paths.push_back({box_path({x, at.y}, {x + each, at.y + kHeight}), {}});
    groups.push_back(box);
  }
  PageGroup outline;
  outline.name = "tint-key";
  outline.stroke = kBlack;
  outline.width = 0.1;
  outline.decoration = true;
  outline.paths.push_back({box_path(at, {at.x + each * static_cast<double>(steps.size()), at.y + kHeight}), {}});
  double free = at.x - 5;
  for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
    const double x = at.x + static_cast<double>(k + 1) * each, half = 0.5 * kWords * width(steps[k].above);
    if (steps[k].above.empty() || x - half < free) continue;
    outline.paths.push_back({line_path({x, at.y}, {x, at.y + kHeight}), {}});
    outline.texts.push_back(words_at({x, at.y + kHeight + 1.8}, steps[k].above, 0, 0.5));
    free = x + half + 1.5;
  }
  groups.push_back(outline);
  return groups;
}

}  // namespace retalho
