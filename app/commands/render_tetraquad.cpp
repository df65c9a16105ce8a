#include "render_tetraquad.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/render/tetraquad_picture.h"

namespace retalho::app {

CutPlane parse_cut(const std::string& text, const Georef& georef) {
  CutPlane cut;
  double value = 0;
  const char* end = text.data() + text.size();
  const auto number = text.size() > 2 ? std::from_chars(text.data() + 2, end, value) : std::from_chars_result{};
  const bool axis = !text.empty() && text[0] >= 'x' && text[0] <= 'z';
  if (!axis || text.size() < 3 || (text[1] != '<' && text[1] != '>') || number.ec != std::errc{} || number.ptr != end ||
      !std::isfinite(value))
    throw UsageError(fmt::format("--cut: '{}' is not an axis, < or >, and a number, such as 'x<0.5'", text), {},
                     "--cut");
  if (text[0] == 'x') value = georef.to_local({value, 0}).x;
  if (text[0] == 'y') value = georef.to_local({0, value}).y;
  const double sign = text[1] == '<' ? 1 : -1;
  cut.normal = {text[0] == 'x' ? sign : 0, text[0] == 'y' ? sign : 0, text[0] == 'z' ? sign : 0};
  cut.offset = sign * value;
  return cut;
}

void add_tetraquad_flags(CLI::App& command, TetraQuadFlags& flags) {
  command.add_option("--up", flags.up, "TetraQuad models: the axis that points up, x, y or z (default z)")
      ->type_name("AXIS");
  command
      .add_option("--cut", flags.cuts, "TetraQuad models: what is kept, such as 'x<0.5'; may be given several times")
      ->type_name("PLANE");
  command.add_flag("--outlines", flags.outlines, "TetraQuad models: where tetrahedra meet");
  command.add_flag("--jumps", flags.jumps, "TetraQuad models: normals that jump across faces, red from 10 degrees on");
}

Image draw_panel(const TetraQuad& surface, const TetraQuadFlags& flags, std::optional<double> from, double elevation,
                 int width, int height, const Context& context) {
  TetraQuadPictureOptions options;
  if (flags.up.size() != 1) throw UsageError("--up is x, y or z", {}, "--up");
  options.up = flags.up[0];
  if (from) options.from = *from;
  options.elevation = elevation;
  options.outlines = flags.outlines;
  if (flags.jumps) options.colors = TetraQuadColors::normal_jumps;
  for (const std::string& cut : flags.cuts) options.cuts.push_back(parse_cut(cut, surface.georef));
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field, 6, context);
  return draw_tetraquad(field, rays, width, height, options, context);
}

std::string kind_text(const TetraQuad& surface) {
  return fmt::format("TetraQuad, {} vertices, {} tetrahedra", surface.mesh.lattice.size(), surface.mesh.tets.size());
}

}  // namespace retalho::app
