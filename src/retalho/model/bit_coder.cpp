#include "retalho/model/bit_coder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace retalho {

double portable_log(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // [1/2, 1): exact
  if (m < 0.70710678118654757) {
    m *= 2;
    --exponent;
  }
  const double s = (m - 1) / (m + 1), q = s * s;
  return exponent * 0.69314718055994531 +
         2 * s * (1 + q * (1.0 / 3 + q * (1.0 / 5 + q * (1.0 / 7 + q * (1.0 / 9 + q * (1.0 / 11))))));
}

double portable_exp(double x) {
  const double whole = std::floor(x * 1.4426950408889634 + 0.5);
  const double r = x - whole * 0.69314718055994531;  // |r| <= 0.35
  const double e =
      1 +
      r * (1 + r * (1.0 / 2 +
                    r * (1.0 / 6 + r * (1.0 / 24 + r * (1.0 / 120 + r * (1.0 / 720 + r * (1.0 / 5040 + r / 40320)))))));
  return std::ldexp(e, static_cast<int>(whole));
}

int log2_class(double x, int steps) {
  x = x > 0x1p-60 ? std::min(x, 0x1p60) : 0x1p-60;
  return static_cast<int>(std::floor(steps * (portable_log(x) * 1.4426950408889634) + 0.5));
}

bool BitCoder::code(bool bit, std::uint32_t one) {
  const std::uint32_t bound = (range_ >> 16) * one;
  if (!writing_) bit = code_ < bound;
  if (bit) {
    range_ = bound;
  } else {
    range_ -= bound;
    if (writing_)
      low_ += bound;
    else
      code_ -= bound;
  }
  if (writing_) carry();
  while (range_ < (1U << 24)) {
    range_ <<= 8;
    if (writing_) {
      out_.push_back(static_cast<char>(low_ >> 24));
      low_ = low_ << 8 & 0xffffffffU;
    } else {
      code_ = code_ << 8 | next();
    }
  }
  return bit;
}

void BitCoder::carry() {
  if (low_ >> 32 == 0) return;
  low_ &= 0xffffffffU;
  for (std::size_t k = out_.size(); k-- > 0;) {
    out_[k] = static_cast<char>(static_cast<unsigned char>(out_[k]) + 1);
    if (out_[k] != 0) break;
  }
}

std::uint32_t BitCoder::code_bits(std::uint32_t value, int count) {
  std::uint32_t result = 0;
  for (int k = count - 1; k >= 0; --k) result = result << 1 | (code_even((value >> k & 1U) != 0) ? 1U : 0U);
  return result;
}

std::uint32_t BitCoder::code_gamma(std::uint32_t value) {
  int length = 0;
  if (writing_)
    while (length < 31 && value >> (length + 1) != 0) ++length;
  int coded = 0;
  while (coded < 31 && code_even(coded < length)) ++coded;
  return 1U << coded | code_bits(value & ((1U << coded) - 1), coded);
}

std::string BitCoder::finish() {
  // Of the numbers that mean the same, the one with the most zeros at its end, which need not be written.
  for (int k = 31; k >= 0; --k) {
    const std::uint64_t mask = (std::uint64_t{1} << k) - 1, value = (low_ + mask) & ~mask;
    if (value - low_ >= range_) continue;
    low_ = value;
    break;
  }
  carry();
  for (int k = 24; k >= 0; k -= 8) out_.push_back(static_cast<char>(low_ >> k & 0xffU));
  while (!out_.empty() && out_.back() == 0) out_.pop_back();
  return std::move(out_);
}

IntegerCoder::IntegerCoder()
    : by_size_(kSizes * kUnary),
      by_place_(kPlaces * kUnary),
      by_kin_(kPlaces * kUnary),
      low_bits_(64),
      signs_(4),
      mixers_(kUnary * 4, Mixer(3, 1.15 / 3, 0.02)) {}

int IntegerCoder::code(BitCoder& coder, int value, int size, int place, int kin, int sign) {
  size = std::clamp(size, 0, kSizes - 1);
  place = std::clamp(place, 0, kPlaces - 1);
  kin = std::clamp(kin, 0, kPlaces - 1);
  static constexpr int kMemory = 255;
  Mixer alone(1, 1, 0);
  const int low = std::max(0, (size - 8) / 2 - 1), magnitude = std::abs(value), high = magnitude >> low;
  int coded = 0;
  for (; coded < kEscape; ++coded) {
    const int u = std::min(coded, kUnary - 1);
    const auto at = [&](std::vector<AdaptiveBit>& bits, int row) {
      return &bits[static_cast<std::size_t>(row * kUnary + u)];
    };
    Mixer& mixer = mixers_[static_cast<std::size_t>(u * 4 + std::min(3, size / 5))];
    if (!code_mixed<3>(coder, high > coded, {at(by_size_, size), at(by_place_, place), at(by_kin_, kin)}, mixer,
                       kMemory))
      break;
  }
  if (coded == kEscape) {
    const std::uint32_t rest = coder.code_gamma(static_cast<std::uint32_t>(std::max(high - kEscape, 0)) + 1) - 1;
    coded += static_cast<int>(std::min(rest, 1U << 30));
  }
  std::uint32_t result = static_cast<std::uint32_t>(coded);
  for (int k = low - 1; k >= 0; --k) {
    AdaptiveBit& bit = low_bits_[static_cast<std::size_t>((low % 8) * 8 + std::min(k, 7))];
    result = result << 1 | (code_mixed<1>(coder, (magnitude >> k & 1) != 0, {&bit}, alone, kMemory) ? 1U : 0U);
  }
  const int found = static_cast<int>(std::min(result, 0x3fffffffU));
  if (found == 0) return 0;
  AdaptiveBit& bit = signs_[static_cast<std::size_t>(sign)];
  return code_mixed<1>(coder, value < 0, {&bit}, alone, kMemory) ? -found : found;
}

}  // namespace retalho
