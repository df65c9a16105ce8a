#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/render/curve_layout.h"

namespace retalho {

namespace {

std::string hex(Rgb c) {
  return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string style(const Stroke& s) {
  if (s.filled) return fmt::format("fill=\"{}\" stroke=\"none\"", hex(s.color));
  return fmt::format(
      "fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{} stroke-linejoin=\"round\" stroke-linecap=\"round\"",
      hex(s.color), s.width, s.dashed ? " stroke-dasharray=\"5 4\"" : "");
}

void append_axes(std::string& svg, const PicturePanel& panel, const PanelLayout& l) {
  svg += fmt::format(
      "<rect class=\"decoration\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"none\" "
      "stroke=\"#999999\"/>\n",
      l.frame_left, l.frame_top, l.frame_width, l.frame_height);
  svg += "<g class=\"decoration\" font-size=\"11\" fill=\"#555555\" stroke=\"none\">\n";
  for (const double x : ticks(panel.low.x, panel.high.x, 8)) {
    const double at = l.place({x, 0}).x;
    if (at < l.frame_left - 0.5 || at > l.frame_left + l.frame_width + 0.5) continue;
    svg += fmt::format(
        "<line x1=\"{0:.2f}\" x2=\"{0:.2f}\" y1=\"{1:.2f}\" y2=\"{2:.2f}\" stroke=\"{3}\"/><text x=\"{0:.2f}\" "
        "y=\"{4:.2f}\" text-anchor=\"middle\">{5:.6g}</text>\n",
        at, l.frame_top, l.frame_top + l.frame_height, x == 0 ? "#bbbbbb" : "#ececec",
        l.frame_top + l.frame_height + 14, x);
  }
  for (const double y : ticks(panel.low.y, panel.high.y, 6)) {
    const double at = l.place({0, y}).y;
    if (at < l.frame_top - 0.5 || at > l.frame_top + l.frame_height + 0.5) continue;
    svg += fmt::format(
        "<line x1=\"{1:.2f}\" x2=\"{2:.2f}\" y1=\"{0:.2f}\" y2=\"{0:.2f}\" stroke=\"{3}\"/><text x=\"{4:.2f}\" "
        "y=\"{5:.2f}\" text-anchor=\"end\">{6:.6g}</text>\n",
        at, l.frame_left, l.frame_left + l.frame_width, y == 0 ? "#bbbbbb" : "#ececec", l.frame_left - 5, at + 4, y);
  }
  svg += "</g>\n";
}

void append_panel(std::string& svg, const PicturePanel& panel, const PanelLayout& l, std::size_t index) {
  if (panel.axes) append_axes(svg, panel, l);
  if (!panel.caption.empty())
    svg += fmt::format(
        "<text class=\"decoration\" x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"13\" text-anchor=\"middle\">{}</text>\n",
        l.frame_left + l.frame_width / 2, l.frame_top + l.frame_height + (panel.axes ? 34 : 18),
        escaped(panel.caption));
  if (!panel.title.empty())
    svg += fmt::format(
        "<text class=\"decoration\" x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"13\" text-anchor=\"middle\">{}</text>\n",
        l.frame_left + l.frame_width / 2, l.frame_top - 8, escaped(panel.title));
  svg += fmt::format(
      "<clipPath id=\"frame{}\"><rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/></clipPath>\n<g "
      "clip-path=\"url(#frame{})\">\n",
      index, l.frame_left, l.frame_top, l.frame_width, l.frame_height, index);
  for (const PictureBox& b : panel.boxes) {
    const Vec2 p = l.place({b.low.x, b.high.y}), q = l.place({b.high.x, b.low.y});
    const double w = std::max(q.x - p.x, 1.5), h = std::max(q.y - p.y, 1.5);
    svg += fmt::format(
        "<rect class=\"decoration\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n",
        (p.x + q.x - w) / 2, (p.y + q.y - h) / 2, w, h, hex(b.color));
  }
  // The group's transform turns y up; strokes keep their width; the numbers in the paths are the curves' own.
  svg += fmt::format("<g class=\"retalho\" transform=\"matrix({} 0 0 {} {} {})\">\n", l.sx, l.sy, l.left, l.top);
  for (const PicturePath& p : panel.paths)
    if (!p.path.points.empty())
      svg += fmt::format("<path{} d=\"{}\" {} vector-effect=\"non-scaling-stroke\"/>\n",
                         p.decoration ? " class=\"decoration\"" : "", to_svg(p.path), style(p.stroke));
  svg += "</g>\n";
  for (const PictureDot& d : panel.dots) {
    const Vec2 p = l.place(d.at);
    svg += d.hollow ? fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\" fill=\"#ffffff\" stroke=\"{}\"/>\n",
                                  p.x, p.y, d.radius, hex(d.color))
                    : fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\" fill=\"{}\"/>\n", p.x, p.y, d.radius,
                                  hex(d.color));
  }
  for (const PictureLabel& t : panel.labels) {
    const Vec2 p = l.place(t.at);
    svg += fmt::format("<text class=\"decoration\" x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"12\" fill=\"{}\">{}</text>\n",
                       p.x + 6, p.y - 6, hex(t.color), escaped(t.text));
  }
  svg += "</g>\n";
}

}  // namespace

namespace {

int columns_of(const CurvePicture& picture) {
  const int panels = static_cast<int>(picture.panels.size());
  return picture.columns > 0 ? std::min(picture.columns, panels) : panels;
}

}  // namespace

int picture_width(const CurvePicture& picture) {
  return columns_of(picture) * picture.panel_width;
}
int picture_height(const CurvePicture& picture) {
  const int panels = static_cast<int>(picture.panels.size()), columns = std::max(columns_of(picture), 1);
  return (panels + columns - 1) / columns * picture.panel_height;
}

PanelLayout layout_panel(const CurvePicture& picture, std::size_t index) {
  const PicturePanel& panel = picture.panels[index];
  const double margin = panel.axes ? 44 : 12, above = panel.title.empty() ? 12 : 28,
               below = (panel.axes ? 26 : 12) + (panel.caption.empty() ? 0 : 16);
  PanelLayout l;
  const auto columns = static_cast<std::size_t>(columns_of(picture));
  const std::size_t row = index / columns;
  l.frame_left = static_cast<double>(index % columns) * picture.panel_width + margin;
  l.frame_top = static_cast<double>(row) * picture.panel_height + above;
  l.frame_width = picture.panel_width - margin - 12;
  l.frame_height = picture.panel_height - above - below;
  const double width = std::max(panel.high.x - panel.low.x, 1e-300),
               height = std::max(panel.high.y - panel.low.y, 1e-300);
  double sx = l.frame_width / width, sy = l.frame_height / height;
  if (!panel.stretch) sx = sy = std::min(sx, sy);
  l.sx = sx;
  l.sy = -sy;
  l.left = l.frame_left + l.frame_width / 2 - sx * (panel.low.x + panel.high.x) / 2;
  l.top = l.frame_top + l.frame_height / 2 + sy * (panel.low.y + panel.high.y) / 2;
  return l;
}

std::vector<double> ticks(double low, double high, int count) {
  const double raw = (high - low) / count;
  if (!(raw > 0) || !std::isfinite(raw)) return {};
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double digit = raw / power;
  const double step = power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
  std::vector<double> result;
  for (double k = std::ceil(low / step); k * step <= high && result.size() < 50; ++k)
    result.push_back(k == 0 ? 0 : k * step);
  return result;
}

std::string to_svg(const CurvePicture& picture) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"DejaVu Sans, sans-serif\">\n"
      "<rect class=\"decoration\" width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
      picture_width(picture), picture_height(picture));
  for (std::size_t i = 0; i < picture.panels.size(); ++i)
    append_panel(svg, picture.panels[i], layout_panel(picture, i), i);
  return svg + "</svg>\n";
}

void fit_panel(PicturePanel& panel) {
  bool any = false;
  Vec2 low, high;
  const auto take = [&](Vec2 p) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
    low = any ? Vec2{std::min(low.x, p.x), std::min(low.y, p.y)} : p;
    high = any ? Vec2{std::max(high.x, p.x), std::max(high.y, p.y)} : p;
    any = true;
  };
  for (const PicturePath& p : panel.paths)
    for (const Vec2 q : p.path.points) take(q);
  for (const PictureDot& d : panel.dots) take(d.at);
  for (const PictureBox& b : panel.boxes) take(b.low), take(b.high);
  if (!any)
    throw BadInput("there is nothing to draw: the curves are empty, or an implicit curve has no point in its box");
  Vec2 size = high - low;
  const double least = std::max({size.x, size.y, 1e-12 * (std::abs(high.x) + std::abs(high.y)), 1e-300});
  if (!(size.x > 1e-9 * least) || (!panel.stretch && size.x < 0.05 * least))
    low.x -= 0.05 * least, high.x += 0.05 * least;
  if (!(size.y > 1e-9 * least) || (!panel.stretch && size.y < 0.05 * least))
    low.y -= 0.05 * least, high.y += 0.05 * least;
  const Vec2 margin = 0.06 * (high - low);
  panel.low = low - margin;
  panel.high = high + margin;
}

}  // namespace retalho
