// retalho contour's map sheets: the options, and from lines to the file.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "program.h"
#include "retalho/level/write_vector.h"
#include "retalho/render/contour_sheet.h"

namespace retalho::app {

struct SheetFlags {
  std::string title, sheet;
  bool curves = false;
};
void add_sheet_flags(CLI::App& command, SheetFlags& flags);

/// The share of the tolerance that lines are traced to when curves are fitted to them.
inline constexpr double kTracedShare = 0.2;

/// Does this file hold a map sheet (.svg, .pdf)?
bool is_sheet(const std::string& path);
/// Throws UsageError when an option of map sheets is given for another file.
void check_sheet_flags(const SheetFlags& flags, const std::string& output);

struct MapSheet {
  SheetContent content;
  double tolerance = 0;  ///< asked for, local units
  SheetReport report;
};

/// Draws and writes, atomically; fills `map.report`.
void write_map_sheet(const Program& program, MapSheet& map, const SheetFlags& flags, const std::string& output,
                     const VectorOptions& file, const Context& context);

nlohmann::ordered_json sheet_json(const SheetReport& report, bool curves);
void append_sheet_lines(std::vector<std::pair<std::string, std::string>>& lines, const SheetReport& report,
                        bool curves);

}  // namespace retalho::app
