// Internal to render/: where the words of a map sheet stand: on their lines, clear of each other and of the frame.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "retalho/level/contours.h"
#include "retalho/render/sheet_page.h"

namespace retalho {

/// A rectangle of any direction, around `centre`.
struct LabelBox {
  Vec2 centre, along{1, 0};  ///< unit vector
  double half_length = 0, half_height = 0;
};
bool overlap(const LabelBox& a, const LabelBox& b);

/// How much of the page is covered with lines, on a raster of quarter millimetres.
class InkMap {
 public:
  InkMap(Vec2 low, Vec2 high);
  void add(Vec2 from, Vec2 to);
  /// The share of the box's raster points that lie on lines.
  double within(const LabelBox& box) const;

 private:
  Vec2 low_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> ink_;
};

/// Takes boxes as long as they are inside of the frame and overlap none taken before.
class LabelRoom {
 public:
  LabelRoom(Vec2 low, Vec2 high) : low_(low), high_(high) {}
  bool has_room(const LabelBox& box) const;
  bool take(const LabelBox& box);
  const std::vector<LabelBox>& taken() const { return taken_; }

 private:
  Vec2 low_, high_;
  std::vector<LabelBox> taken_;
};

/// Width of a text, for an em of 1.
using TextWidth = std::function<double(const std::string&)>;
TextWidth measure_text();

/// Labels of the lines with `chosen(level)`, each on a straight stretch of its line, the text running along it: uphill,
/// which lies to the left of every line, is up. Where there is a choice, where the fewest lines lie beneath. `lines` in
/// page coordinates (y down, uphill still on the side that was left with y up).
std::vector<PageText> place_line_labels(const ContourSet& lines, const std::function<bool(int)>& chosen,
                                        const std::function<std::string(int)>& words, double size,
                                        const TextWidth& width, const InkMap& ink, LabelRoom& room);

}  // namespace retalho
