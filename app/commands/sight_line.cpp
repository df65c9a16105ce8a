#include "sight_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "retalho/render/profile_picture.h"

namespace retalho::app {

void report_sight_line(const Program& program, const SightLine& line, const Georef& georef, bool frequency,
                       const std::string& output) {
  if (!output.empty()) write_picture(profile_picture(line, georef.unit), output, program.overwrite);
  nlohmann::ordered_json json = {{"visible", line.visible}, {"distance", line.profile.back().distance}};
  const auto number = [](double v) {
    return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(nullptr);
  };
  json["clearance"] = number(line.clearance);
  json["blocked_at"] = number(line.blocked_at);
  if (frequency) json["fresnel_clearance"] = number(line.fresnel_clear);
  json["profile"] = nlohmann::ordered_json::array();
  for (const ProfilePoint& p : line.profile) {
    const Vec2 at = georef.to_crs(p.at);
    nlohmann::ordered_json point = {
        {"distance", p.distance}, {"x", at.x}, {"y", at.y}, {"ground", number(p.ground)}, {"sight", p.sight}};
    if (frequency) point["fresnel_radius"] = p.fresnel;
    json["profile"].push_back(point);
  }
  if (program.json) return program.print(json);
  std::string text =
      line.visible
          ? fmt::format("visible over {:.6g}, lowest clearance {:.6g}\n", line.profile.back().distance, line.clearance)
          : fmt::format("not visible: blocked at {:.6g} of {:.6g}\n", line.blocked_at, line.profile.back().distance);
  if (frequency)
    text += fmt::format("first Fresnel zone: {:.0f} % clear at the narrowest\n",
                        100 * std::clamp(line.fresnel_clear, 0.0, 1.0));
  program.print(text);
}

}  // namespace retalho::app
