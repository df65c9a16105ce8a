#include "retalho/render/sheet_labels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>

#include "retalho/render/text.h"

namespace retalho {
namespace {

constexpr double kInkStep = 0.25;
constexpr double kCandidateStep = 2;  // mm along a line
constexpr double kSameLine = 60;      // mm between two labels of a line
constexpr double kAnyLine = 14;       // mm between labels of different lines
constexpr double kLeastChord = 0.95;  // of the stretch under a label: straighter than this

struct Candidate {
  LabelBox box;
  double score = 0;  ///< lower is better
  std::size_t line = 0;
  double along = 0;  ///< mm from the line's start
};

std::array<Vec2, 4> corners(const LabelBox& b) {
  const Vec2 u = b.half_length * b.along, v = b.half_height * Vec2{-b.along.y, b.along.x};
  return {b.centre + u + v, b.centre + u - v, b.centre - u - v, b.centre - u + v};
}

/// A line by its length.
class Measured {
 public:
  Measured(const ContourSet& set, const ContourLine& line) : closed_(line.closed) {
    for (std::size_t i = line.begin; i < line.end; ++i) add(set.points[i]);
    if (closed_) add(set.points[line.begin]);
  }
  double length() const { return at_.back(); }
  Vec2 point(double s) const {
    if (closed_) s = std::fmod(std::fmod(s, length()) + length(), length());
    const auto after = std::upper_bound(at_.begin(), at_.end(), s);
    const std::size_t k = std::min<std::size_t>(static_cast<std::size_t>(after - at_.begin()), at_.size() - 1);
    const double part = at_[k] > at_[k - 1] ? (s - at_[k - 1]) / (at_[k] - at_[k - 1]) : 0;
    return points_[k - 1] + std::clamp(part, 0.0, 1.0) * (points_[k] - points_[k - 1]);
  }

 private:
  void add(Vec2 p) {
    at_.push_back(points_.empty() ? 0 : at_.back() + norm(p - points_.back()));
    points_.push_back(p);
  }
  std::vector<Vec2> points_;
  std::vector<double> at_;
  bool closed_;
};

}  // namespace

bool overlap(const LabelBox& a, const LabelBox& b) {
  const auto pa = corners(a), pb = corners(b);
  for (const LabelBox* box : {&a, &b})
    for (const Vec2 axis : {box->along, Vec2{-box->along.y, box->along.x}}) {
      double a0 = dot(pa[0], axis), a1 = a0, b0 = dot(pb[0], axis), b1 = b0;
      for (std::size_t i = 1; i < 4; ++i) {
        a0 = std::min(a0, dot(pa[i], axis));
        a1 = std::max(a1, dot(pa[i], axis));
        b0 = std::min(b0, dot(pb[i], axis));
        b1 = std::max(b1, dot(pb[i], axis));
      }
      if (a1 < b0 || b1 < a0) return false;
    }
  return true;
}

InkMap::InkMap(Vec2 low, Vec2 high) : low_(low) {
  columns_ = static_cast<int>((high.x - low.x) / kInkStep) + 1;
  rows_ = static_cast<int>((high.y - low.y) / kInkStep) + 1;
  ink_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
}

void InkMap::add(Vec2 from, Vec2 to) {
  const int steps = static_cast<int>(norm(to - from) / (0.8 * kInkStep)) + 1;
  for (int k = 0; k <= steps; ++k) {
    const Vec2 p = from + (static_cast<double>(k) / steps) * (to - from);
    const int c = static_cast<int>((p.x - low_.x) / kInkStep), r = static_cast<int>((p.y - low_.y) / kInkStep);
    if (c >= 0 && r >= 0 && c < columns_ && r < rows_)
      ink_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] = 1;
  }
}

double InkMap::within(const LabelBox& box) const {
  const int nu = static_cast<int>(2 * box.half_length / kInkStep) + 1;
  const int nv = static_cast<int>(2 * box.half_height / kInkStep) + 1;
  const Vec2 across{-box.along.y, box.along.x};
  int hit = 0;
  for (int i = 0; i <= nu; ++i)
    for (int j = 0; j <= nv; ++j) {
      const Vec2 p =
          box.centre + box.half_length * (2.0 * i / nu - 1) * box.along + box.half_height * (2.0 * j / nv - 1) * across;
      const int c = static_cast<int>((p.x - low_.x) / kInkStep), r = static_cast<int>((p.y - low_.y) / kInkStep);
      if (c >= 0 && r >= 0 && c < columns_ && r < rows_)
        hit += ink_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)];
    }
  return static_cast<double>(hit) / ((nu + 1) * (nv + 1));
}

bool LabelRoom::has_room(const LabelBox& box) const {
  for (const Vec2 p : corners(box))
    if (p.x < low_.x || p.y < low_.y || p.x > high_.x || p.y > high_.y) return false;
  return std::none_of(taken_.begin(), taken_.end(), [&](const LabelBox& other) { return overlap(box, other); });
}

bool LabelRoom::take(const LabelBox& box) {
  if (!has_room(box)) return false;
  taken_.push_back(box);
  return true;
}

TextWidth measure_text() {
  constexpr double kPixels = 64;
  const auto font = std::make_shared<Font>(kPixels);
  return [font](const std::string& text) { return font->width(text) / kPixels; };
}

std::vector<PageText> place_line_labels(const ContourSet& lines, const std::function<bool(int)>& chosen,
                                        const std::function<std::string(int)>& words, double size,
                                        const TextWidth& width, const InkMap& ink, LabelRoom& room) {
  std::vector<Candidate> candidates;
  for (std::size_t l = 0; l < lines.lines.size(); ++l) {
    const ContourLine& line = lines.lines[l];
    if (!chosen(line.level) || line.end - line.begin < 2) continue;
    const Measured measured(lines, line);
    const double half = 0.5 * size * width(words(line.level)) + 0.7;
    if (measured.length() < 4 * half) continue;
    const double first = line.closed ? 0 : 1.5 * half, last = measured.length() - first;
    for (double s = first; s <= last; s += kCandidateStep) {
      const Vec2 a = measured.point(s - half), b = measured.point(s + half), m = measured.point(s);
      const double chord = norm(b - a);
      if (chord < kLeastChord * 2 * half) continue;
      const Vec2 middle = 0.25 * a + 0.25 * b + 0.5 * m;
      const LabelBox box{middle, (b - a) / chord, half, 0.5 * size};
      if (!room.has_room(box)) continue;
      const double bent = norm(m - 0.5 * (a + b)) / size;
      candidates.push_back({box, ink.within(box) + bent, l, s});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  std::vector<PageText> labels;
  std::vector<Candidate> placed;
  for (const Candidate& c : candidates) {
    const bool crowded = std::any_of(placed.begin(), placed.end(), [&](const Candidate& other) {
      const double apart = norm(other.box.centre - c.box.centre);
      return apart < kAnyLine || (other.line == c.line && apart < kSameLine);
    });
    if (crowded || !room.take(c.box)) continue;
    placed.push_back(c);
    PageText text;
    text.at = c.box.centre;
    text.text = words(lines.lines[c.line].level);
    text.size = size;
    text.angle = std::atan2(c.box.along.y, c.box.along.x) * 180 / std::numbers::pi;
    labels.push_back(text);
  }
  return labels;
}

}  // namespace retalho
