#include <cairo-pdf.h>
#include <cairo.h>
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <new>
#include <numbers>

#include "retalho/core/error.h"
#include "retalho/render/sheet_page.h"

namespace retalho {
namespace {

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Canvas = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

constexpr double kPoints = 72 / 25.4;  // a millimetre

/// Cairo keeps paths in 1/256 of a unit, which for a page in points is coarser than lines of a dense map lie apart.
/// So paths are drawn 256 times as large on a surface of their own, which the page shows made small again: still
/// vectors, in 1/65536 of a point.
constexpr double kFine = 256;

void set_color(cairo_t* c, Rgb color) {
  cairo_set_source_rgb(c, color.r / 255.0, color.g / 255.0, color.b / 255.0);
}

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw CannotWrite(fmt::format("cannot draw the sheet: {}", cairo_status_to_string(status)));
}

void trace_path(cairo_t* c, const PlanePath& path) {
  std::size_t at = 0;
  Vec2 current;
  for (const PathVerb verb : path.verbs) {
    switch (verb) {
      case PathVerb::move:
        current = path.points[at++];
        cairo_move_to(c, current.x, current.y);
        break;
      case PathVerb::line:
        current = path.points[at++];
        cairo_line_to(c, current.x, current.y);
        break;
      case PathVerb::quad: {
        const Vec2 q = path.points[at++], end = path.points[at++];
        const Vec2 a = current + 2.0 / 3 * (q - current), b = end + 2.0 / 3 * (q - end);
        cairo_curve_to(c, a.x, a.y, b.x, b.y, end.x, end.y);
        current = end;
        break;
      }
      case PathVerb::cubic: {
        const Vec2 a = path.points[at++], b = path.points[at++];
        current = path.points[at++];
        cairo_curve_to(c, a.x, a.y, b.x, b.y, current.x, current.y);
        break;
      }
      case PathVerb::close:
        cairo_close_path(c);
        break;
    }
  }
}

void draw_paths(cairo_t* page, const PageGroup& group, const SheetPage& sheet) {
  const cairo_rectangle_t extents{0, 0, sheet.width * kPoints * kFine, sheet.height * kPoints * kFine};
  const Surface large(cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, &extents), cairo_surface_destroy);
  const Canvas canvas(cairo_create(large.get()), cairo_destroy);
  cairo_t* c = canvas.get();
  cairo_scale(c, kPoints * kFine, kPoints * kFine);
  if (group.clipped) {
    cairo_rectangle(c, sheet.frame_low.x, sheet.frame_low.y, sheet.frame_high.x - sheet.frame_low.x,
                    sheet.frame_high.y - sheet.frame_low.y);
    cairo_clip(c);
  }
  cairo_set_fill_rule(c, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(c, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_width(c, group.width);
  for (const PagePath& path : group.paths) {
    cairo_new_path(c);
    trace_path(c, path.path);
    if (group.fill) {
      set_color(c, *group.fill);
      cairo_fill_preserve(c);
    }
    if (group.stroke) {
      set_color(c, *group.stroke);
      cairo_stroke(c);
    }
  }
  check(cairo_status(c));
  cairo_save(page);
  cairo_scale(page, 1 / kFine, 1 / kFine);
  cairo_set_source_surface(page, large.get(), 0, 0);
  cairo_paint(page);
  cairo_restore(page);
}

void draw_text(cairo_t* c, const PageText& text) {
  cairo_save(c);
  cairo_translate(c, text.at.x * kPoints, text.at.y * kPoints);
  cairo_rotate(c, text.angle * std::numbers::pi / 180);
  cairo_set_font_size(c, text.size * kPoints);
  cairo_text_extents_t extents;
  cairo_text_extents(c, text.text.c_str(), &extents);
  const double x = -text.anchor * extents.x_advance, y = 0.36 * text.size * kPoints;
  if (text.halo > 0) {
    cairo_move_to(c, x, y);
    cairo_text_path(c, text.text.c_str());
    cairo_set_source_rgb(c, 1, 1, 1);
    cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_width(c, text.halo * kPoints);
    cairo_stroke(c);
  }
  set_color(c, text.color);
  cairo_move_to(c, x, y);
  cairo_show_text(c, text.text.c_str());
  cairo_restore(c);
}

cairo_status_t append_bytes(void* to, const unsigned char* bytes, unsigned int count) {
  try {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(bytes), count);
  } catch (const std::bad_alloc&) {  // not through C code
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string page_pdf(const SheetPage& sheet) {
  std::string bytes;
  const Surface surface(
      cairo_pdf_surface_create_for_stream(append_bytes, &bytes, sheet.width * kPoints, sheet.height * kPoints),
      cairo_surface_destroy);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "retalho");
  if (!sheet.title.empty())
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, sheet.title.c_str());
  // No time of day in the file: the same map gives the same bytes.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
  {
    const Canvas canvas(cairo_create(surface.get()), cairo_destroy);
    cairo_t* c = canvas.get();
    cairo_select_font_face(c, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    for (const PageGroup& group : sheet.groups) {
      if (!group.paths.empty()) draw_paths(c, group, sheet);
      for (const PageText& text : group.texts) draw_text(c, text);
    }
    check(cairo_status(c));
  }
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return bytes;
}

}  // namespace retalho
