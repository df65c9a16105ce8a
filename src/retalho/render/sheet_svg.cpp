#include <fmt/format.h>

#include "retalho/render/sheet_page.h"

namespace retalho {
namespace {

std::string hex(Rgb c) {
  return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        // XML has no place for the other control characters.
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

void append(std::string& svg, const PageText& text) {
  const char* anchor = text.anchor < 0.25 ? "start" : text.anchor > 0.75 ? "end" : "middle";
  // Half of a digit's height below `at`, since SVG places the baseline.
  svg += fmt::format("<text transform=\"translate({:.3f} {:.3f})", text.at.x, text.at.y);
  if (text.angle != 0) svg += fmt::format(" rotate({:.2f})", text.angle);
  svg += fmt::format("\" y=\"{:.3f}\" font-size=\"{:g}\" text-anchor=\"{}\" fill=\"{}\"", 0.36 * text.size, text.size,
                     anchor, hex(text.color));
  if (text.halo > 0)
    svg += fmt::format(" stroke=\"#ffffff\" stroke-width=\"{:g}\" stroke-linejoin=\"round\" paint-order=\"stroke\"",
                       text.halo);
  svg += fmt::format(">{}</text>\n", escaped(text.text));
}

}  // namespace

std::string page_svg(const SheetPage& page) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}mm\" height=\"{1:g}mm\" viewBox=\"0 0 {0:g} {1:g}\" "
      "font-family=\"DejaVu Sans, sans-serif\">\n<title>{2}</title>\n"
      "<rect class=\"decoration\" width=\"{0:g}\" height=\"{1:g}\" fill=\"#ffffff\"/>\n"
      "<clipPath id=\"frame\"><rect x=\"{3:.4f}\" y=\"{4:.4f}\" width=\"{5:.4f}\" height=\"{6:.4f}\"/></clipPath>\n",
      page.width, page.height, escaped(page.title), page.frame_low.x, page.frame_low.y,
      page.frame_high.x - page.frame_low.x, page.frame_high.y - page.frame_low.y);
  for (const PageGroup& group : page.groups) {
    svg += fmt::format("<g id=\"{}\"{} fill=\"{}\" fill-rule=\"evenodd\"", group.name,
                       group.decoration ? " class=\"decoration\"" : "", group.fill ? hex(*group.fill) : "none");
    if (group.stroke)
      svg += fmt::format(" stroke=\"{}\" stroke-width=\"{:g}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"",
                         hex(*group.stroke), group.width);
    if (group.clipped) svg += " clip-path=\"url(#frame)\"";
    svg += ">\n";
    for (const PagePath& path : group.paths)
      svg += fmt::format("<path{}{} d=\"{}\"/>\n", path.note.empty() ? "" : " ", path.note, to_svg(path.path));
    svg += "</g>\n";
    if (group.texts.empty()) continue;
    svg += fmt::format("<g id=\"{}-words\" class=\"decoration\">\n", group.name);
    for (const PageText& text : group.texts) append(svg, text);
    svg += "</g>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace retalho
