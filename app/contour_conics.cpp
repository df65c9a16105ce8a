#include "contour_conics.h"

#include <fmt/format.h>

#include <utility>

#include "retalho/core/atomic_file.h"
#include "retalho/curve/document.h"
#include "retalho/level/conics.h"
#include "table.h"

namespace retalho::app {

void write_conics(const Program& program, const Terrain& terrain, std::vector<double> levels, const std::string& output,
                  const Context& context) {
  const Stopwatch watch;
  ConicSet set = trace_conics(terrain, std::move(levels), context);
  move_to_crs(set, terrain.georef);
  CurveDocument document;
  std::size_t closed = 0, segments = 0;
  for (const ConicLine& line : set.lines) {
    closed += line.curve.closed ? 1 : 0;
    segments += line.curve.segment_count();
    document.curves.push_back(to_spec(line.curve));
    document.curves.back().name = fmt::format("{}", set.levels[static_cast<std::size_t>(line.level)]);
  }
  context.check();
  write_file(output, to_json(document), program.overwrite);
  if (set.lines.empty()) program.say("no line at these levels: the file has no curves");
  if (program.json)
    return program.print({{"levels", set.levels.size()},
                          {"lines", set.lines.size()},
                          {"closed_lines", closed},
                          {"conics", segments},
                          {"height_quantum", set.height_quantum},
                          {"seconds", watch.seconds()}});
  program.print(list_text({{"levels", fmt::format("{}", set.levels.size())},
                           {"lines", fmt::format("{} ({} closed)", set.lines.size(), closed)},
                           {"conics", fmt::format("{}", segments)},
                           {"seconds", fmt::format("{:.2f}", watch.seconds())}}));
}

}  // namespace retalho::app
