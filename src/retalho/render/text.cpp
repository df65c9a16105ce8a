#include "retalho/render/text.h"

#include <fmt/format.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <cmath>
#include <cstdlib>
#include <string>

#include "retalho/core/error.h"

#ifndef RETALHO_FONT_FILE
#define RETALHO_FONT_FILE "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
#endif

namespace retalho {
namespace {

/// The next code point of UTF-8 text; moves `at` behind it. '?' for a byte that starts none.
unsigned long next_code_point(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(at++);
  const int more = lead < 0x80 ? 0 : (lead >> 5) == 6 ? 1 : (lead >> 4) == 14 ? 2 : (lead >> 3) == 30 ? 3 : -1;
  if (more == 0) return lead;
  if (more < 0 || at + static_cast<std::size_t>(more) > text.size()) return '?';
  unsigned long code = lead & (0x3FU >> more);
  for (int k = 0; k < more; ++k) {
    const unsigned char next = byte(at + static_cast<std::size_t>(k));
    if ((next & 0xC0) != 0x80) return '?';
    code = (code << 6) | (next & 0x3FU);
  }
  at += static_cast<std::size_t>(more);
  return code;
}

std::string font_file() {
  const char* chosen = std::getenv("RETALHO_FONT");
  return chosen && *chosen ? chosen : RETALHO_FONT_FILE;
}

}  // namespace

struct Font::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  ~Face() {
    if (face) FT_Done_Face(face);
    if (library) FT_Done_FreeType(library);
  }

  /// Calls use(glyph slot, pen x in 1/64 pixel) for each character, and returns the pen's end.
  template <typename Use>
  FT_Pos walk(std::string_view text, FT_Int32 flags, const Use& use) const {
    FT_Pos pen = 0;
    FT_UInt previous = 0;
    for (std::size_t at = 0; at < text.size();) {
      const FT_UInt glyph = FT_Get_Char_Index(face, next_code_point(text, at));
      FT_Vector kerning{0, 0};
      if (previous && glyph) FT_Get_Kerning(face, previous, glyph, FT_KERNING_DEFAULT, &kerning);
      pen += kerning.x;
      previous = glyph;
      if (FT_Load_Glyph(face, glyph, flags) != 0) continue;
      use(face->glyph, pen);
      pen += face->glyph->advance.x;
    }
    return pen;
  }
};

Font::Font(double pixels) : face_(std::make_unique<Face>()) {
  const std::string file = font_file();
  if (FT_Init_FreeType(&face_->library) != 0 || FT_New_Face(face_->library, file.c_str(), 0, &face_->face) != 0)
    throw CannotRead(
        fmt::format("cannot read the font '{}': install fonts-dejavu-core, or name a font in RETALHO_FONT", file),
        file);
  FT_Set_Char_Size(face_->face, 0, static_cast<FT_F26Dot6>(std::lround(pixels * 64)), 72, 72);
}

Font::~Font() = default;
Font::Font(Font&&) noexcept = default;
Font& Font::operator=(Font&&) noexcept = default;

int Font::ascent() const {
  return static_cast<int>((face_->face->size->metrics.ascender + 63) >> 6);
}
int Font::descent() const {
  return static_cast<int>((-face_->face->size->metrics.descender + 63) >> 6);
}

int Font::width(std::string_view text) const {
  return static_cast<int>((face_->walk(text, FT_LOAD_DEFAULT, [](FT_GlyphSlot, FT_Pos) {}) + 63) >> 6);
}

void Font::draw(Image& image, int x, int baseline, std::string_view text, Rgb color) const {
  face_->walk(text, FT_LOAD_RENDER, [&](FT_GlyphSlot slot, FT_Pos pen) {
    const FT_Bitmap& bitmap = slot->bitmap;
    const int left = x + static_cast<int>((pen + 32) >> 6) + slot->bitmap_left, top = baseline - slot->bitmap_top;
    for (int row = 0; row < static_cast<int>(bitmap.rows); ++row)
      for (int column = 0; column < static_cast<int>(bitmap.width); ++column) {
        const int px = left + column, py = top + row;
        if (px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
        const int cover = bitmap.buffer[row * bitmap.pitch + column];
        const auto mix = [cover](std::uint8_t under, std::uint8_t over) {
          return static_cast<std::uint8_t>((under * (255 - cover) + over * cover + 127) / 255);
        };
        Rgb& pixel = image.at(px, py);
        pixel = {mix(pixel.r, color.r), mix(pixel.g, color.g), mix(pixel.b, color.b)};
      }
  });
}

std::string Font::shortened(std::string_view text, int pixels) const {
  if (width(text) <= pixels) return std::string(text);
  for (std::size_t kept = text.size() - 1; kept > 0; --kept) {
    const std::size_t front = (kept + 1) / 2;
    const std::string form = fmt::format("{}...{}", text.substr(0, front), text.substr(text.size() - (kept - front)));
    if (width(form) <= pixels) return form;
  }
  return {};
}

}  // namespace retalho
