#include "render_tetraquad.h"

#include <fmt/format.h>

#include "retalho/core/error.h"
#include "retalho/render/tetraquad_picture.h"

namespace retalho::app {

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
