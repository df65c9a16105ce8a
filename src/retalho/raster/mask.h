// Which cells of a grid hold a height: one bit a cell.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace retalho {

class Mask {
 public:
  Mask() = default;
  Mask(int columns, int rows, bool value)
      : columns_(columns),
        rows_(rows),
        stride_((static_cast<std::size_t>(columns) + 63) / 64),
        words_(stride_ * static_cast<std::size_t>(rows)) {
    if (value)
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) set(c, r, true);
  }

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool empty() const { return words_.empty(); }

  bool get(int column, int row) const { return (words_[word(column, row)] >> (column & 63)) & 1U; }
  void set(int column, int row, bool value) {
    const std::uint64_t bit = std::uint64_t{1} << (column & 63);
    if (value)
      words_[word(column, row)] |= bit;
    else
      words_[word(column, row)] &= ~bit;
  }

  /// How many cells are valid.
  std::size_t count() const {
    std::size_t n = 0;
    for (const std::uint64_t w : words_) n += static_cast<std::size_t>(std::popcount(w));
    return n;
  }

  /// The bits, rows padded to whole words; bits behind the last column are zero.
  const std::vector<std::uint64_t>& words() const { return words_; }
  std::vector<std::uint64_t>& words() { return words_; }

  friend bool operator==(const Mask&, const Mask&) = default;

 private:
  std::size_t word(int column, int row) const {
    return static_cast<std::size_t>(row) * stride_ + static_cast<std::size_t>(column) / 64;
  }

  int columns_ = 0, rows_ = 0;
  std::size_t stride_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace retalho
