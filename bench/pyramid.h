// A peer for compact models: the plain grid by an interpolating pyramid, every cell within a largest error.
//
// From a coarse lattice down, each new cell is predicted by cubic interpolation of known ones; what remains is rounded
// to twice the largest error (coarser levels finer, by 1.25 a level, as their errors are passed on) and coded by the
// range coder that the compact form uses. Nothing but the grid comes of it: no surface between the cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "retalho/model/bit_coder.h"
#include "retalho/model/compact_cells.h"
#include "retalho/raster/raster.h"

namespace retalho::bench {

class PyramidCoder {
 public:
  /// Writes `raster`, or reads into a grid of its size with its valid cells.
  PyramidCoder(BitCoder& coder, const Raster& raster, double max_error)
      : coder_(coder),
        raster_(raster),
        columns_(raster.columns),
        rows_(raster.rows),
        error_(max_error),
        reference_(std::round(summarize(raster).mean)),
        z_(raster.cells(), NAN),
        missed_(raster.cells(), 0) {}

  std::vector<double> run() {
    Mask valid = valid_mask(raster_);
    const bool masked = valid.count() < raster_.cells();
    if (coder_.code_even(masked)) valid = code_mask(coder_, columns_, rows_, valid);
    valid_ = std::move(valid);
    int top = 0;
    while ((2 << top) < std::max(columns_, rows_)) ++top;
    top = std::min(top, 9);
    base_ = 1 << top;
    start_level(top);
    for (int y = 0; y < rows_; y += base_)
      for (int x = 0; x < columns_; x += base_)
        code(x, y, x >= base_ && !std::isnan(at(x - base_, y)) ? at(x - base_, y) : reference_, base_);
    for (int level = top - 1; level >= 0; --level) {
      start_level(level);
      const int s = 1 << level;
      for (int y = 0; y < rows_; y += 2 * s)
        for (int x = s; x < columns_; x += 2 * s) code(x, y, along(x, y, s, 0), s);
      for (int y = s; y < rows_; y += 2 * s)
        for (int x = 0; x < columns_; x += 2 * s) code(x, y, along(x, y, 0, s), s);
      for (int y = s; y < rows_; y += 2 * s)
        for (int x = s; x < columns_; x += 2 * s) code(x, y, middle(along(x, y, s, 0), along(x, y, 0, s)), s);
    }
    return z_;
  }

 private:
  void start_level(int level) {
    level_ = level;
    step_ = 2 * error_ * (1 - 1e-9) / std::pow(1.25, level);
  }
  std::size_t index(int x, int y) const { return raster_.index(x, y); }
  double at(int x, int y) const { return x < 0 || y < 0 || x >= columns_ || y >= rows_ ? NAN : z_[index(x, y)]; }
  static double middle(double a, double b) { return std::isnan(a) ? b : std::isnan(b) ? a : (a + b) / 2; }

  /// Cubic through four neighbours; fewer where there are fewer.
  double along(int x, int y, int dx, int dy) const {
    const double a = at(x - 3 * dx, y - 3 * dy), b = at(x - dx, y - dy), c = at(x + dx, y + dy),
                 d = at(x + 3 * dx, y + 3 * dy);
    if (std::isnan(b) || std::isnan(c)) {
      const double near = std::isnan(b) ? c : b, far = std::isnan(b) ? d : a;
      return std::isnan(near) || std::isnan(far) ? near : (3 * near - far) / 2;
    }
    if (!std::isnan(a) && !std::isnan(d)) return (9 * (b + c) - a - d) / 16;
    if (!std::isnan(a)) return (6 * b + 3 * c - a) / 8;
    if (!std::isnan(d)) return (3 * b + 6 * c - d) / 8;
    return (b + c) / 2;
  }

  void code(int x, int y, double prediction, int s) {
    if (!valid_.get(x, y)) return;
    if (std::isnan(prediction)) prediction = reference_;
    // How far cells nearby were from their predictions: those of this level before it, and the coarser ones around.
    double sum = 0, weight = 0;
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i) {
        const int u = x + i * s, v = y + j * s;
        if ((i == 0 && j == 0) || u < 0 || v < 0 || u >= columns_ || v >= rows_ || std::isnan(z_[index(u, v)]))
          continue;
        const double w = std::abs(i) + std::abs(j) <= 1 ? 2 : std::abs(i) + std::abs(j) <= 2 ? 1 : 0.5;
        sum += w * missed_[index(u, v)];
        weight += w;
      }
    const double expected = weight > 0 ? sum / weight : 1;
    const int size = 8 + log2_class(expected + 0.02, 2), fine = std::clamp(log2_class(expected + 0.02, 4) + 24, 0, 63);
    const int place =
        std::min(level_, 5) * 10 + std::clamp(log2_class(missed_[index(std::max(0, x - s), y)] + 0.1, 1) + 4, 0, 9);
    const double z = raster_.at(x, y);
    const int q = coder_.writing() ? static_cast<int>(std::lround((z - prediction) / step_)) : 0;
    const int coded = coders_[level_ == 0 ? 0 : 1].code(coder_, q, size, place, fine, 0);
    z_[index(x, y)] = prediction + coded * step_;
    missed_[index(x, y)] = static_cast<float>(std::abs(coded));
  }

  BitCoder& coder_;
  const Raster& raster_;
  int columns_, rows_, base_ = 1, level_ = 0;
  double error_, reference_, step_ = 1;
  std::vector<double> z_;
  std::vector<float> missed_;  // in steps
  Mask valid_;
  IntegerCoder coders_[2];
};

/// The bytes, after they have been read again and every cell compared. Throws std::runtime_error where one is off.
inline std::size_t pyramid_bytes(const Raster& raster, double max_error) {
  BitCoder writer;
  const std::vector<double> written = PyramidCoder(writer, raster, max_error).run();
  const std::string bytes = writer.finish();
  BitCoder reader(bytes);
  const std::vector<double> read = PyramidCoder(reader, raster, max_error).run();
  for (std::size_t k = 0; k < read.size(); ++k) {
    if (std::isnan(read[k]) != std::isnan(raster.at(k)) || (!std::isnan(read[k]) && read[k] != written[k]))
      throw std::runtime_error("the pyramid's bytes do not give its grid back");
    if (std::abs(read[k] - raster.at(k)) > max_error) throw std::runtime_error("a cell of the pyramid is off");
  }
  constexpr std::size_t kHeader = 24;  // size, error, mean, place: not written out here
  return bytes.size() + kHeader;
}

}  // namespace retalho::bench
