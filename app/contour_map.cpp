#include "contour_map.h"

#include <fmt/format.h>

#include "inputs.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"

namespace retalho::app {
void add_sheet_flags(CLI::App& command, SheetFlags& flags) {
  command.add_flag("--curves", flags.curves, "Map sheets: smooth Bézier curves within the tolerance, not polylines");
  command.add_option("--title", flags.title, "Map sheets: words above the map")->type_name("TEXT");
  command
      .add_option("--sheet", flags.sheet,
                  "Map sheets: A0 to A6, upright or not as the map is, or WIDTHxHEIGHT in mm (default A4)")
      ->type_name("SIZE");
}

bool is_sheet(const std::string& path) {
  return path.ends_with(".svg") || path.ends_with(".pdf");
}

void check_sheet_flags(const SheetFlags& flags, const std::string& output) {
  if (is_sheet(output)) {
    if (!flags.sheet.empty()) sheet_size(flags.sheet, 1);
    return;
  }
  const char* given = flags.curves           ? "--curves"
                      : !flags.title.empty() ? "--title"
                      : !flags.sheet.empty() ? "--sheet"
                                             : nullptr;
  if (given != nullptr)
    throw UsageError(fmt::format("{} is for map sheets: name the output .svg or .pdf", given), {}, given);
}

void write_map_sheet(const Program& program, MapSheet& map, const SheetFlags& flags, const std::string& output,
                     const VectorOptions& file, const Context& context) {
  SheetContent& content = map.content;
  content.index = index_levels(content.lines->levels, file);
  SheetOptions options;
  options.size = sheet_size(flags.sheet.empty() ? "A4" : flags.sheet, content.extent.width() / content.extent.height());
  options.title = flags.title;
  options.crs_name = crs_name(content.georef.crs_wkt);
  options.levels = level_words(content.lines->levels, content.height_unit, file);
  options.curves = flags.curves;
  options.tolerance = map.tolerance;
  options.traced = flags.curves ? content.lines->tolerance : 0;
  write_file(output, contour_sheet(content, options, output.ends_with(".pdf"), map.report, context), program.overwrite);
  if (map.report.unproved > 0)
    program.say(
        fmt::format("{} pairs of traced lines are so close that their rounded coordinates could not be told "
                    "apart on the sheet",
                    map.report.unproved));
}

nlohmann::ordered_json sheet_json(const SheetReport& report, bool curves) {
  nlohmann::ordered_json json = {{"mm_per_unit", report.scale}, {"labels", report.labels}, {"spots", report.spots}};
  if (curves) {
    json["curves"] = report.curves;
    json["straight_pieces"] = report.straight;
    json["corners"] = report.corners;
    json["unproved_pairs"] = report.unproved;
  }
  return json;
}

void append_sheet_lines(std::vector<std::pair<std::string, std::string>>& lines, const SheetReport& report,
                        bool curves) {
  lines.emplace_back("labels", fmt::format("{}, and {} spot heights", report.labels, report.spots));
  if (curves)
    lines.emplace_back("curves", fmt::format("{} ({} pieces stayed straight)", report.curves, report.straight));
}

}  // namespace retalho::app
