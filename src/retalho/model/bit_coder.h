// Binary arithmetic coding with adaptive, mixed probabilities: what the compact form of a model file is written with
// (docs/compact-file.md). One object either writes or reads, and the same calls do both, so that what is written and
// what is read cannot mean different things. Internal to the room.
//
// Probabilities are doubles. Every operation on them is one of IEEE 754's exactly rounded ones in the order of the
// source (the build forbids contraction), logarithm and exponential included: every machine reads the same bits.
// Sources: the carrying range coder of Martin (1979); mixing in the logistic domain, Mahoney (2005).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace retalho {

/// Natural logarithm of a positive normal number, exponential of a number within +-700: relative error under 1e-9, the
/// same bits everywhere.
double portable_log(double x);
double portable_exp(double x);

/// floor(steps * log2(x) + 1/2) for x > 0, the same everywhere; x is held to [2^-60, 2^60].
int log2_class(double x, int steps);

class BitCoder {
 public:
  BitCoder() = default;                      ///< writes
  explicit BitCoder(std::string_view bytes)  ///< reads; what lies behind the end is zeros
      : writing_(false), bytes_(bytes) {
    for (int k = 0; k < 4; ++k) code_ = code_ << 8 | next();
  }

  bool writing() const { return writing_; }
  /// Codes `bit` (reading: ignores it) whose chance to be 1 is `one` / 65536, 0 < one < 65536. Returns the bit.
  bool code(bool bit, std::uint32_t one);
  bool code_even(bool bit) { return code(bit, 32768); }
  /// `count` bits, the highest first, each as likely as not.
  std::uint32_t code_bits(std::uint32_t value, int count);
  /// 1 and up, Elias' gamma code.
  std::uint32_t code_gamma(std::uint32_t value);
  /// The bytes written. Call once, last.
  std::string finish();

 private:
  std::uint8_t next() { return at_ < bytes_.size() ? static_cast<std::uint8_t>(bytes_[at_++]) : std::uint8_t{0}; }
  void carry();

  bool writing_ = true;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::uint32_t code_ = 0, range_ = 0xffffffffU;
  std::uint64_t low_ = 0;
  std::string out_;
};

/// How often a bit was 1 lately.
struct AdaptiveBit {
  double p = 0.5;
  int seen = 0;

  void update(bool bit, int memory) {
    p += ((bit ? 1.0 : 0.0) - p) / (seen + 1.6);
    p = p < 1.0 / 4096 ? 1.0 / 4096 : p > 4095.0 / 4096 ? 4095.0 / 4096 : p;
    if (seen < memory) ++seen;
  }
};

/// Weighs the opinions of up to 8 contexts.
struct Mixer {
  std::array<double, 8> weight{};
  double rate = 0.02;

  Mixer() = default;
  Mixer(std::size_t inputs, double each, double learning) : rate(learning) {
    for (std::size_t k = 0; k < inputs; ++k) weight[k] = each;
  }
};

/// Codes a bit by the mixed opinion of `Count` adaptive contexts and, where `prior` is in (0, 1), a probability known
/// beforehand, which takes the mixer's last weight.
template <std::size_t Count>
bool code_mixed(BitCoder& coder, bool bit, const std::array<AdaptiveBit*, Count>& contexts, Mixer& mixer, int memory,
                double prior = 0) {
  static_assert(Count < 8);
  std::array<double, 8> stretched{};
  double sum = 0;
  for (std::size_t k = 0; k < Count; ++k) {
    stretched[k] = portable_log(contexts[k]->p / (1 - contexts[k]->p));
    sum += mixer.weight[k] * stretched[k];
  }
  if (prior > 0) {
    stretched[7] = portable_log(prior / (1 - prior));
    sum += mixer.weight[7] * stretched[7];
  }
  constexpr double kSure = 10.5;
  sum = sum < -kSure ? -kSure : sum > kSure ? kSure : sum;
  const double p = 1 / (1 + portable_exp(-sum));
  const auto scaled = static_cast<std::uint32_t>(p * 65536);
  bit = coder.code(bit, scaled < 2 ? 2 : scaled > 65534 ? 65534 : scaled);
  const double error = ((bit ? 1.0 : 0.0) - p) * mixer.rate;
  for (std::size_t k = 0; k < Count; ++k) {
    mixer.weight[k] += error * stretched[k];
    contexts[k]->update(bit, memory);
  }
  if (prior > 0) mixer.weight[7] += error * stretched[7];
  return bit;
}

/// Signed whole numbers whose expected size is known in classes of half an octave.
class IntegerCoder {
 public:
  static constexpr int kSizes = 32;  ///< class 8: about 1 expected
  static constexpr int kPlaces = 64;

  IntegerCoder();
  /// `size` in [0, kSizes): the expected magnitude; `place` and `kin` in [0, kPlaces): what else the size may depend
  /// on; `sign` in [0, 4): what the sign may depend on. |value| < 2^30. Returns the value.
  int code(BitCoder& coder, int value, int size, int place, int kin, int sign);

 private:
  static constexpr int kUnary = 18, kEscape = 24;
  std::vector<AdaptiveBit> by_size_, by_place_, by_kin_, low_bits_, signs_;
  std::vector<Mixer> mixers_;
};

}  // namespace retalho
