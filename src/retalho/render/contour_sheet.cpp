#include "retalho/render/contour_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "retalho/core/error.h"
#include "retalho/level/line_curves.h"
#include "retalho/render/color.h"
#include "retalho/render/contour_path.h"
#include "retalho/render/sheet_frame.h"
#include "retalho/render/sheet_labels.h"
#include "retalho/render/sheet_page.h"

namespace retalho {
namespace {

constexpr double kMargin = 8, kTicks = 5, kTitle = 10, kFooter = 12, kLegend = 8;  // mm
constexpr double kLabel = 2.2, kSpot = 2.0, kWords = 2.3;                          // heights of letters, mm
constexpr double kHalo = 0.7;
constexpr double kSpotsApart = 12;  // mm: more would hide the lines
constexpr Rgb kLine{140, 90, 45}, kIndex{100, 58, 22}, kPit{30, 80, 140}, kInk{0, 0, 0};

SheetMap make_map(const SheetContent& content, const SheetOptions& options) {
  const double width = content.extent.width(), height = content.extent.height();
  if (!(width > 0) || !(height > 0)) throw BadInput("a map sheet needs an area: the surface has no width or no height");
  const double above = kMargin + kTicks + (options.title.empty() ? 0 : kTitle);
  const double below = kMargin + kTicks + kFooter + (content.bands != nullptr ? kLegend : 0);
  const double side = kMargin + kTicks;
  const Vec2 room{options.size.x - 2 * side, options.size.y - above - below};
  if (!(room.x >= 20 && room.y >= 20))
    throw UsageError(fmt::format("a sheet of {:g} x {:g} mm has no room for a map and its margin: take a larger one",
                                 options.size.x, options.size.y),
                     {}, "--sheet");
  SheetMap map;
  map.scale = std::min(room.x / width, room.y / height);
  const Vec2 size{width * map.scale, height * map.scale};
  map.low = {side + 0.5 * (room.x - size.x), above + 0.5 * (room.y - size.y)};
  map.high = map.low + size;
  map.origin = {content.extent.low.x, content.extent.high.y};
  // Rounding takes a thousandth of the tolerance at most.
  const double fine = options.tolerance > 0 ? options.tolerance * map.scale / 1000 : 1e-4;
  map.per_unit = std::pow(10, std::clamp(std::ceil(-std::log10(fine)), 4.0, 9.0));
  return map;
}

/// The lines on the page.
ContourSet on_page(const ContourSet& lines, const SheetMap& map) {
  ContourSet page = lines;
  for (Vec2& p : page.points) p = map.place(p);
  return page;
}

std::string number(double height) {
  return fmt::format("{:.10g}", height);
}

PageGroup tint_group(const BandPolygon& polygon, const SheetMap& map, Rgb color) {
  PageGroup group;
  group.fill = group.stroke = color;
  group.width = 0.03;  // closes the hairline between neighbours
  group.clipped = group.decoration = true;
  PlanePath path;
  const auto add = [&](const BandRing& ring) {
    for (std::size_t i = 0; i < ring.points.size(); ++i) {
      path.verbs.push_back(i == 0 ? PathVerb::move : PathVerb::line);
      path.points.push_back(map.place(ring.points[i]));
    }
    path.verbs.push_back(PathVerb::close);
  };
  add(polygon.outer);
  for (const BandRing& hole : polygon.holes) add(hole);
  group.paths.push_back({std::move(path), {}});
  return group;
}

void add_tints(SheetPage& page, const SheetContent& content, const SheetMap& map, double width,
               const TextWidth& measure) {
  const BandSet& bands = *content.bands;
  if (bands.polygons.empty()) return;
  int first = bands.polygons.front().band, last = first;
  for (const BandPolygon& p : bands.polygons) {
    first = std::min(first, p.band);
    last = std::max(last, p.band);
  }
  const auto color = [&](int band) {
    const double t = last > first ? static_cast<double>(band - first) / (last - first) : 0.5;
    return to_rgb(0.5 * ramp_color(ColorRamp::hypsometric, t) + 0.5 * Color{1, 1, 1});
  };
  int current = -1;
  for (const BandPolygon& p : bands.polygons) {
    PageGroup group = tint_group(p, map, color(p.band));
    if (p.band == current) {
      page.groups.back().paths.push_back(std::move(group.paths.front()));
      continue;
    }
    current = p.band;
    group.name = fmt::format("tint-{}", p.band);
    page.groups.push_back(std::move(group));
  }
  std::vector<TintStep> steps;
  for (int band = first; band <= last; ++band)
    steps.push_back({color(band), band < last ? number(bands.levels[static_cast<std::size_t>(band)]) : std::string()});
  const double top = map.high.y + kTicks + kFooter + 2;
  for (PageGroup& group : draw_tint_legend(steps, {kMargin + kTicks, top}, width, measure))
    page.groups.push_back(std::move(group));
}

PlanePath curve(const CurveSet& set, const CurveLine& line) {
  PlanePath path;
  path.verbs.push_back(PathVerb::move);
  path.points.push_back(set.pieces[line.begin].points[0]);
  for (std::size_t i = line.begin; i < line.end; ++i) {
    const CurvePiece& piece = set.pieces[i];
    path.verbs.push_back(piece.straight ? PathVerb::line : PathVerb::cubic);
    if (!piece.straight) path.points.insert(path.points.end(), {piece.points[1], piece.points[2]});
    path.points.push_back(piece.points[3]);
  }
  if (line.closed) path.verbs.push_back(PathVerb::close);
  return path;
}

/// Lines that run closer than the page's unit (around flats) meet by rounding alone: those take more digits.
CurveSet page_curves(const ContourSet& ground, const ContourSet& page, const SheetOptions& options, SheetMap map,
                     const Context& context) {
  constexpr double kFinest = 1e9, kMore = 1000;
  const auto fit = [&](const ContourSet& lines) {
    // What tracing and rounding have used up of the tolerance, the curves may not.
    const double left = (options.tolerance - options.traced) * map.scale - 2 / map.per_unit;
    return fit_line_curves(lines, {left, options.traced * map.scale, map.per_unit}, context);
  };
  CurveSet curves = fit(page);
  while (curves.unproved > 0 && map.per_unit < kFinest) {
    map.per_unit = std::min(kFinest, kMore * map.per_unit);
    curves = fit(on_page(ground, map));
  }
  return curves;
}

void add_lines(SheetPage& page, const SheetContent& content, const SheetOptions& options, const ContourSet& lines,
               const SheetMap& map, SheetReport& report, const Context& context) {
  PageGroup ordinary, index;
  ordinary.name = "contours";
  ordinary.stroke = kLine;
  ordinary.width = 0.12;
  index.name = "index-contours";
  index.stroke = kIndex;
  index.width = 0.3;
  ordinary.clipped = index.clipped = true;
  const auto add = [&](int level, PlanePath path) {
    PageGroup& group = content.index[static_cast<std::size_t>(level)] ? index : ordinary;
    group.paths.push_back(
        {std::move(path), fmt::format("data-elev=\"{}\"", number(lines.levels[static_cast<std::size_t>(level)]))});
  };
  if (options.curves) {
    const CurveSet curves = page_curves(*content.lines, lines, options, map, context);
    for (const CurveLine& line : curves.lines) add(line.level, curve(curves, line));
    report.straight = curves.straight;
    report.curves = curves.pieces.size() - curves.straight;
    report.corners = curves.corners;
    report.unproved = curves.unproved;
  } else {
    for (const ContourLine& line : lines.lines) add(line.level, contour_path(lines, line));
  }
  page.groups.push_back(std::move(ordinary));
  page.groups.push_back(std::move(index));
}

/// A triangle that points up for a summit and down for a pit.
PlanePath spot_mark(Vec2 at, bool summit) {
  const double r = 0.75, s = summit ? 1 : -1;
  return {{PathVerb::move, PathVerb::line, PathVerb::line, PathVerb::close},
          {{at.x, at.y - s * r}, {at.x + 0.87 * r, at.y + 0.5 * s * r}, {at.x - 0.87 * r, at.y + 0.5 * s * r}}};
}

void add_spots(SheetPage& page, const SheetContent& content, const SheetMap& map, const InkMap& ink,
               const TextWidth& measure, LabelRoom& room, SheetReport& report) {
  PageGroup summits, pits;
  summits.name = "summits";
  summits.fill = kInk;
  pits.name = "pits";
  pits.fill = kPit;
  summits.decoration = pits.decoration = true;
  const double step = spot_prominence(content.lines->levels, content.low, content.high);
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step / 9.99))), 0, 6);
  std::vector<Vec2> placed;
  for (const SpotHeight& spot : content.spots) {
    const Vec2 at = map.place(spot.at);
    const std::string words = fmt::format("{:.{}f}", spot.height, decimals);
    const double half = 0.5 * kSpot * measure(words) + 0.2, high = 0.5 * kSpot;
    const LabelBox mark{at, {1, 0}, 1.1, 1.1};
    const bool crowded =
        std::any_of(placed.begin(), placed.end(), [&](Vec2 other) { return norm(other - at) < kSpotsApart; });
    if (crowded || !room.has_room(mark)) continue;
    LabelBox best;
    double least = 2;
    for (const Vec2 way : {Vec2{1.3 + half, 0}, Vec2{-1.3 - half, 0}, Vec2{0, -1.3 - high}, Vec2{0, 1.3 + high}}) {
      const LabelBox box{at + way, {1, 0}, half, high};
      const double used = ink.within(box);
      if (used < least && room.has_room(box)) {
        least = used;
        best = box;
      }
    }
    if (least > 1) continue;
    room.take(best);
    room.take(mark);
    placed.push_back(at);
    PageGroup& group = spot.summit ? summits : pits;
    group.paths.push_back({spot_mark(at, spot.summit), {}});
    PageText text;
    text.at = best.centre;
    text.text = words;
    text.size = kSpot;
    text.color = *group.fill;
    text.halo = kHalo;
    group.texts.push_back(text);
    ++report.spots;
  }
  page.groups.push_back(std::move(summits));
  page.groups.push_back(std::move(pits));
}

PageGroup words_group(const std::string& name, Vec2 at, const std::string& text, double size, double anchor) {
  PageGroup group;
  group.name = name;
  group.decoration = true;
  PageText words;
  words.at = at;
  words.text = text;
  words.size = size;
  words.anchor = anchor;
  group.texts.push_back(words);
  return group;
}

/// Smaller letters where a line of words would not fit.
double fitting(const std::string& text, double size, double room, const TextWidth& measure) {
  return std::min(size, room / std::max(measure(text), 1e-9));
}

void add_margin(SheetPage& page, const SheetContent& content, const SheetOptions& options, const SheetMap& map,
                const TextWidth& measure) {
  const double left = kMargin + kTicks, right = page.width - left, room = right - left;
  page.groups.push_back(draw_frame(map, content.georef, measure));
  if (!options.title.empty())
    page.groups.push_back(words_group("title", {0.5 * page.width, map.low.y - kTicks - 6}, options.title,
                                      fitting(options.title, 5, room, measure), 0.5));
  const double top = map.high.y + kTicks + 2.5;
  page.groups.push_back(draw_scale_bar(map, content.georef.unit, {left + 2, top}, std::min(60.0, 0.35 * room)));
  const std::string unit = content.height_unit.empty() ? std::string() : " " + content.height_unit;
  std::vector<std::string> lines{options.levels,
                                 fmt::format("Heights {:.6g} to {:.6g}{}", content.low, content.high, unit),
                                 options.crs_name.empty() ? "No coordinate reference system" : options.crs_name};
  if (const std::string scale = scale_words(map, content.georef.unit); !scale.empty()) lines[2] += ", " + scale;
  PageGroup words = words_group("margin", {}, {}, kWords, 1);
  words.texts.clear();
  for (std::size_t k = 0; k < lines.size(); ++k) {
    PageText text;
    text.at = {right, top + 3.4 * static_cast<double>(k)};
    text.text = lines[k];
    text.size = fitting(lines[k], kWords, 0.5 * room, measure);
    text.anchor = 1;
    words.texts.push_back(text);
  }
  page.groups.push_back(std::move(words));
}

}  // namespace

Vec2 sheet_size(std::string_view name, double aspect) {
  if (name.size() == 2 && (name[0] == 'A' || name[0] == 'a') && name[1] >= '0' && name[1] <= '6') {
    constexpr std::array<double, 8> kSides{1189, 841, 594, 420, 297, 210, 148, 105};
    const auto k = static_cast<std::size_t>(name[1] - '0');
    return aspect >= 1 ? Vec2{kSides[k], kSides[k + 1]} : Vec2{kSides[k + 1], kSides[k]};
  }
  const std::string text(name);
  char* end = nullptr;
  const double width = std::strtod(text.c_str(), &end);
  if (end != text.c_str() && (*end == 'x' || *end == 'X')) {
    const char* second = end + 1;
    const double height = std::strtod(second, &end);
    if (end != second && (*end == '\0' || std::string_view(end) == "mm") && width >= 80 && height >= 80 &&
        width <= 5000 && height <= 5000)
      return {width, height};
  }
  throw UsageError(
      fmt::format("--sheet: '{}' is no sheet: A0 to A6, or WIDTHxHEIGHT in mm, 80 to 5000 each (297x210)", name), {},
      "--sheet");
}

namespace {

/// 1st, 2nd, 3rd, 5th, 11th.
const char* ordinal(int n) {
  if (n % 100 >= 11 && n % 100 <= 13) return "th";
  return n % 10 == 1 ? "st" : n % 10 == 2 ? "nd" : n % 10 == 3 ? "rd" : "th";
}

}  // namespace

std::string level_words(const std::vector<double>& levels, const std::string& height_unit, const VectorOptions& lines) {
  const std::string unit = height_unit.empty() ? std::string() : " " + height_unit;
  const std::string every = lines.index_every > 0 ? fmt::format("; every {}{} is an index contour", lines.index_every,
                                                                ordinal(lines.index_every))
                                                  : std::string();
  if (lines.interval > 0) return fmt::format("Contour lines every {:.6g}{}{}", lines.interval, unit, every);
  return fmt::format("Contour lines at {} heights{}", levels.size(), every);
}

std::vector<bool> index_levels(const std::vector<double>& levels, const VectorOptions& lines) {
  std::vector<bool> index;
  for (std::size_t k = 0; k < levels.size(); ++k) index.push_back(is_index_level(levels, static_cast<int>(k), lines));
  return index;
}

std::string contour_sheet(const SheetContent& content, const SheetOptions& options, bool pdf, SheetReport& report,
                          const Context& context) {
  report = {};
  const SheetMap map = make_map(content, options);
  report.scale = map.scale;
  const TextWidth measure = measure_text();
  const ContourSet lines = on_page(*content.lines, map);
  SheetPage page;
  page.width = options.size.x;
  page.height = options.size.y;
  page.frame_low = map.low;
  page.frame_high = map.high;
  page.title = options.title.empty() ? "Contour lines" : options.title;
  context.report("draw", 0);
  if (content.bands != nullptr) add_tints(page, content, map, page.width - 2 * (kMargin + kTicks), measure);
  add_lines(page, content, options, lines, map, report, context);
  context.check();

  InkMap ink(map.low, map.high);
  for (const ContourLine& line : lines.lines)
    for (std::size_t i = line.begin + 1; i < line.end; ++i) ink.add(lines.points[i - 1], lines.points[i]);
  const Vec2 inset{0.6, 0.6};
  LabelRoom room(map.low + inset, map.high - inset);
  add_spots(page, content, map, ink, measure, room, report);
  const bool any_index = std::any_of(lines.lines.begin(), lines.lines.end(), [&](const ContourLine& line) {
    return content.index[static_cast<std::size_t>(line.level)];
  });
  PageGroup labels = words_group("labels", {}, {}, kLabel, 0.5);
  labels.texts = place_line_labels(
      lines, [&](int level) { return !any_index || content.index[static_cast<std::size_t>(level)]; },
      [&](int level) { return number(lines.levels[static_cast<std::size_t>(level)]); }, kLabel, measure, ink, room);
  for (PageText& text : labels.texts) {
    text.color = kIndex;
    text.halo = kHalo;
  }
  report.labels = labels.texts.size();
  page.groups.push_back(std::move(labels));
  if (lines.lines.empty()) {
    const std::string words =
        content.high > content.low
            ? fmt::format("No contour line: the heights lie between {:.6g} and {:.6g}", content.low, content.high)
            : fmt::format("No contour line: all heights are {:.6g}", content.low);
    const double width = map.high.x - map.low.x - 4;
    page.groups.push_back(
        words_group("nothing", 0.5 * (map.low + map.high), words, fitting(words, 3.5, width, measure), 0.5));
  }
  add_margin(page, content, options, map, measure);
  context.report("draw", 1);
  return pdf ? page_pdf(page) : page_svg(page);
}

}  // namespace retalho
