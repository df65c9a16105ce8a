#include <cairo-pdf.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <new>
#include <string>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/render/curve_layout.h"

namespace retalho {

namespace {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Canvas = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

void set_color(cairo_t* c, Rgb color) {
  cairo_set_source_rgb(c, color.r / 255.0, color.g / 255.0, color.b / 255.0);
}

void draw_text(cairo_t* c, const std::string& text, double x, double y, double size, double anchor, Rgb color) {
  cairo_set_font_size(c, size);
  cairo_text_extents_t extents;
  cairo_text_extents(c, text.c_str(), &extents);
  set_color(c, color);
  cairo_move_to(c, x - anchor * extents.x_advance, y);
  cairo_show_text(c, text.c_str());
}

void trace_path(cairo_t* c, const PlanePath& path, const PanelLayout& l) {
  std::size_t at = 0;
  Vec2 current;
  const auto next = [&] { return l.place(path.points[at++]); };
  cairo_new_path(c);
  for (const PathVerb verb : path.verbs) {
    switch (verb) {
      case PathVerb::move:
        current = next();
        cairo_move_to(c, current.x, current.y);
        break;
      case PathVerb::line:
        current = next();
        cairo_line_to(c, current.x, current.y);
        break;
      case PathVerb::quad: {
        const Vec2 q = next(), end = next();
        const Vec2 a = current + 2.0 / 3 * (q - current), b = end + 2.0 / 3 * (q - end);
        cairo_curve_to(c, a.x, a.y, b.x, b.y, end.x, end.y);
        current = end;
        break;
      }
      case PathVerb::cubic: {
        const Vec2 a = next(), b = next();
        current = next();
        cairo_curve_to(c, a.x, a.y, b.x, b.y, current.x, current.y);
        break;
      }
      case PathVerb::close:
        cairo_close_path(c);
        break;
    }
  }
}

void draw_axes(cairo_t* c, const PicturePanel& panel, const PanelLayout& l) {
  const Rgb grey{85, 85, 85};
  cairo_set_line_width(c, 1);
  const auto line = [&](double x0, double y0, double x1, double y1, bool zero) {
    set_color(c, zero ? Rgb{187, 187, 187} : Rgb{236, 236, 236});
    cairo_move_to(c, x0, y0);
    cairo_line_to(c, x1, y1);
    cairo_stroke(c);
  };
  for (const double x : ticks(panel.low.x, panel.high.x, 8)) {
    const double at = l.place({x, 0}).x;
    if (at < l.frame_left - 0.5 || at > l.frame_left + l.frame_width + 0.5) continue;
    line(at, l.frame_top, at, l.frame_top + l.frame_height, x == 0);
    draw_text(c, fmt::format("{:.6g}", x), at, l.frame_top + l.frame_height + 14, 11, 0.5, grey);
  }
  for (const double y : ticks(panel.low.y, panel.high.y, 6)) {
    const double at = l.place({0, y}).y;
    if (at < l.frame_top - 0.5 || at > l.frame_top + l.frame_height + 0.5) continue;
    line(l.frame_left, at, l.frame_left + l.frame_width, at, y == 0);
    draw_text(c, fmt::format("{:.6g}", y), l.frame_left - 5, at + 4, 11, 1, grey);
  }
  set_color(c, {153, 153, 153});
  cairo_rectangle(c, l.frame_left, l.frame_top, l.frame_width, l.frame_height);
  cairo_stroke(c);
}

void draw_panel(cairo_t* c, const PicturePanel& panel, const PanelLayout& l) {
  if (panel.axes) draw_axes(c, panel, l);
  if (!panel.caption.empty())
    draw_text(c, panel.caption, l.frame_left + l.frame_width / 2, l.frame_top + l.frame_height + (panel.axes ? 34 : 18),
              13, 0.5, {});
  if (!panel.title.empty()) draw_text(c, panel.title, l.frame_left + l.frame_width / 2, l.frame_top - 8, 13, 0.5, {});
  cairo_save(c);
  cairo_rectangle(c, l.frame_left, l.frame_top, l.frame_width, l.frame_height);
  cairo_clip(c);
  for (const PictureBox& b : panel.boxes) {
    const Vec2 p = l.place({b.low.x, b.high.y}), q = l.place({b.high.x, b.low.y});
    const double w = std::max(q.x - p.x, 1.5), h = std::max(q.y - p.y, 1.5);
    set_color(c, b.color);
    cairo_rectangle(c, (p.x + q.x - w) / 2, (p.y + q.y - h) / 2, w, h);
    cairo_fill(c);
  }
  cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(c, CAIRO_LINE_CAP_ROUND);
  for (const PicturePath& p : panel.paths) {
    if (p.path.points.empty()) continue;
    trace_path(c, p.path, l);
    set_color(c, p.stroke.color);
    const double dash[] = {5, 4};
    cairo_set_dash(c, dash, p.stroke.dashed ? 2 : 0, 0);
    cairo_set_line_width(c, p.stroke.width);
    p.stroke.filled ? cairo_fill(c) : cairo_stroke(c);
  }
  cairo_set_dash(c, nullptr, 0, 0);
  for (const PictureDot& d : panel.dots) {
    const Vec2 p = l.place(d.at);
    cairo_new_path(c);
    cairo_arc(c, p.x, p.y, d.radius, 0, 2 * 3.14159265358979323846);
    if (d.hollow) {
      set_color(c, {255, 255, 255});
      cairo_fill_preserve(c);
      set_color(c, d.color);
      cairo_set_line_width(c, 1);
      cairo_stroke(c);
    } else {
      set_color(c, d.color);
      cairo_fill(c);
    }
  }
  for (const PictureLabel& t : panel.labels) {
    const Vec2 p = l.place(t.at);
    draw_text(c, t.text, p.x + 6, p.y - 6, 12, 0, t.color);
  }
  cairo_restore(c);
}

void draw_all(const CurvePicture& picture, cairo_surface_t* surface, double zoom, const std::string& path) {
  const Canvas canvas(cairo_create(surface), cairo_destroy);
  cairo_scale(canvas.get(), zoom, zoom);
  set_color(canvas.get(), {255, 255, 255});
  cairo_paint(canvas.get());
  cairo_select_font_face(canvas.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  for (std::size_t i = 0; i < picture.panels.size(); ++i)
    draw_panel(canvas.get(), picture.panels[i], layout_panel(picture, i));
  if (const cairo_status_t status = cairo_status(canvas.get()); status != CAIRO_STATUS_SUCCESS)
    throw CannotWrite(fmt::format("cannot draw: {}", cairo_status_to_string(status)), path);
}

/// Cairo's own files do not say when the disk is full: its bytes go through our writer.
cairo_status_t append(void* bytes, const unsigned char* data, unsigned int size) {
  try {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
  } catch (const std::bad_alloc&) {  // not through C code
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

void write_with_cairo(const CurvePicture& picture, const std::string& path, bool pdf, bool overwrite) {
  std::string bytes;
  const int width = picture_width(picture), height = picture_height(picture);
  constexpr int kZoom = 2;  // PNG: two device pixels a picture pixel, for sharp lines
  const Surface surface(pdf ? cairo_pdf_surface_create_for_stream(append, &bytes, width, height)
                            : cairo_image_surface_create(CAIRO_FORMAT_RGB24, width * kZoom, height * kZoom),
                        cairo_surface_destroy);
  cairo_status_t status = CAIRO_STATUS_SUCCESS;
  if (pdf) {
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "retalho");
    // No time of day in the file: the same curves give the same bytes.
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
    draw_all(picture, surface.get(), 1, path);
    cairo_surface_finish(surface.get());
    status = cairo_surface_status(surface.get());
  } else {
    draw_all(picture, surface.get(), kZoom, path);
    status = cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
  }
  if (status != CAIRO_STATUS_SUCCESS)
    throw CannotWrite(fmt::format("cannot write: {}", cairo_status_to_string(status)), path);
  write_file(path, bytes, overwrite);
}

}  // namespace

void write_picture(const CurvePicture& picture, const std::string& path, bool overwrite) {
  if (picture.panels.empty())
    throw BadInput("there is nothing to draw: the curves are empty, or an implicit curve has no point in its box");
  if (path.ends_with(".svg")) return write_file(path, to_svg(picture), overwrite);
  if (path.ends_with(".pdf")) return write_with_cairo(picture, path, true, overwrite);
  if (path.ends_with(".png")) return write_with_cairo(picture, path, false, overwrite);
  throw UsageError("a drawing's name must end in .svg, .pdf or .png", path);
}

}  // namespace retalho
