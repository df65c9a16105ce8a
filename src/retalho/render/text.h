// Words in a picture, in the DejaVu Sans face. FreeType stands behind this header and nowhere else.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "retalho/render/image.h"

namespace retalho {

/// The face at one size. Not for use from several threads at once.
class Font {
 public:
  /// `pixels`: height of the line's em. The font file is the one found when the library was built, or $RETALHO_FONT.
  /// Throws CannotRead when it is missing.
  explicit Font(double pixels);
  ~Font();
  Font(Font&&) noexcept;
  Font& operator=(Font&&) noexcept;

  int ascent() const;   ///< pixels above the baseline
  int descent() const;  ///< pixels below it, > 0

  /// Width in pixels of UTF-8 text. Bytes that are no UTF-8 count as '?'.
  int width(std::string_view text) const;

  /// Draws with the baseline's left end at (x, baseline), antialiased; what falls outside of the image is cut off.
  void draw(Image& image, int x, int baseline, std::string_view text, Rgb color = {0, 0, 0}) const;

  /// The longest form that is at most `pixels` wide: the text, or its two ends around "...".
  std::string shortened(std::string_view text, int pixels) const;

 private:
  struct Face;
  std::unique_ptr<Face> face_;
};

}  // namespace retalho
