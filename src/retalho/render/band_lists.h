// Internal to render: what touches each band of rows of a picture, so that bands are drawn by themselves, in parallel,
// each with samples for its own rows only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace retalho {

/// A list for each band of `rows` rows of a picture of `height` rows, made by a counting sort: every piece is put
/// twice, in the same order, with turn() in between. A band's list keeps that order.
template <typename Piece>
class BandLists {
 public:
  BandLists(int height, int rows)
      : height_(height), rows_(rows), begin_(static_cast<std::size_t>((height + rows - 1) / rows) + 1) {}

  /// A piece that touches the rows from `low` to `high`. What is not in the picture, or NaN, is left out.
  void put(const Piece& piece, double low, double high) {
    if (!(high >= 0) || !(low <= height_ - 1)) return;
    const auto first = static_cast<std::size_t>(std::max(low, 0.0)) / static_cast<std::size_t>(rows_),
               last = static_cast<std::size_t>(std::min(high, height_ - 1.0)) / static_cast<std::size_t>(rows_);
    for (std::size_t b = first; b <= last; ++b) {
      if (next_.empty())
        ++begin_[b + 1];
      else
        pieces_[next_[b]++] = piece;
    }
  }
  /// After the first round: makes room for what was counted.
  void turn() {
    for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
    pieces_.resize(begin_.back());
    next_ = begin_;
  }

  std::size_t count() const { return begin_.size() - 1; }
  /// First row and the one after the last.
  std::pair<int, int> rows(std::size_t band) const {
    const int first = static_cast<int>(band) * rows_;
    return {first, std::min(height_, first + rows_)};
  }
  std::span<const Piece> of(std::size_t band) const {
    return std::span<const Piece>(pieces_).subspan(begin_[band], begin_[band + 1] - begin_[band]);
  }

 private:
  int height_, rows_;
  std::vector<std::size_t> begin_, next_;
  std::vector<Piece> pieces_;
};

/// Samples that a band's canvas holds, 16 to 32 bytes each: few enough for a cache.
inline constexpr int kBandSamples = 1 << 18;

}  // namespace retalho
