// Heights that arrive in order and are kept as float as long as float is exact for every one of them, then as double.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>
#include <vector>

namespace retalho {

class HeightSink {
 public:
  /// Reserves room for `cells` floats (address space; pages are taken as they fill).
  explicit HeightSink(std::size_t cells) : cells_(cells) { floats_.reserve(cells); }

  /// NaN is a void cell. Infinite heights are for the caller to turn into NaN.
  void add(double height) {
    if (doubles_.empty()) {
      if (is_float(height)) {
        floats_.push_back(static_cast<float>(height));
        return;
      }
      widen();
    }
    doubles_.push_back(height);
  }

  std::size_t size() const { return doubles_.empty() ? floats_.size() : doubles_.size(); }

  std::variant<std::vector<float>, std::vector<double>> take() {
    if (doubles_.empty()) return std::move(floats_);
    return std::move(doubles_);
  }

 private:
  static bool is_float(double height) {
    if (std::isnan(height)) return true;
    if (std::abs(height) > static_cast<double>(std::numeric_limits<float>::max())) return false;
    return static_cast<double>(static_cast<float>(height)) == height;
  }
  void widen() {
    doubles_.reserve(cells_);
    doubles_.assign(floats_.begin(), floats_.end());
    floats_ = {};
  }

  std::size_t cells_;
  std::vector<float> floats_;
  std::vector<double> doubles_;
};

}  // namespace retalho
