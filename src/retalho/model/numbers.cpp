#include "retalho/model/numbers.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <memory>
#include <new>
#include <optional>

#include "retalho/core/error.h"

namespace retalho {
namespace {

// Higher levels gain under 1 % on shuffled mantissas and cost several times the time.
constexpr int kLevel = 9;
constexpr int kMostDecimals = 6;
constexpr std::array<double, kMostDecimals + 1> kPowersOfTen = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6};

[[noreturn]] void damaged(const std::string& words, const char* what) {
  throw CannotRead(words, {}, what);
}

constexpr std::uint64_t zigzag(std::uint64_t v) {
  return (v << 1) ^ (0 - (v >> 63));
}
constexpr std::uint64_t unzigzag(std::uint64_t v) {
  return (v >> 1) ^ (0 - (v & 1));
}

/// Byte k of every number, for k = 0, 1, ...: bytes of one significance resemble each other.
std::string shuffle(std::span<const std::uint64_t> values, std::size_t width) {
  std::string bytes(values.size() * width, '\0');
  for (std::size_t k = 0; k < width; ++k)
    for (std::size_t i = 0; i < values.size(); ++i)
      bytes[k * values.size() + i] = static_cast<char>((values[i] >> (8 * k)) & 0xff);
  return bytes;
}

std::vector<std::uint64_t> unshuffle(std::string_view bytes, std::size_t count, std::size_t width) {
  std::vector<std::uint64_t> values(count, 0);
  for (std::size_t k = 0; k < width; ++k)
    for (std::size_t i = 0; i < count; ++i)
      values[i] |= std::uint64_t{static_cast<unsigned char>(bytes[k * count + i])} << (8 * k);
  return values;
}

PackedNumbers pack_coded(std::span<const std::uint64_t> zigzagged, bool differences) {
  std::uint64_t all = 0;
  for (const std::uint64_t v : zigzagged) all |= v;
  const auto bits = std::bit_width(all);
  const std::uint8_t width = bits <= 8 ? 1 : bits <= 16 ? 2 : bits <= 32 ? 4 : 8;
  return {zigzagged.size(), NumberForm::integers, width, differences, 0, compress(shuffle(zigzagged, width))};
}

/// The values times 10^decimals, where dividing gives back each one to the bit.
std::optional<std::vector<std::int64_t>> as_integers(std::span<const double> values, double power) {
  std::vector<std::int64_t> integers;
  integers.reserve(values.size());
  for (const double v : values) {
    const double scaled = std::nearbyint(v * power);
    if (!(std::abs(scaled) <= 9007199254740992.0)) return std::nullopt;  // 2^53
    const auto integer = static_cast<std::int64_t>(scaled);
    if (std::bit_cast<std::uint64_t>(static_cast<double>(integer) / power) != std::bit_cast<std::uint64_t>(v))
      return std::nullopt;
    integers.push_back(integer);
  }
  return integers;
}

bool fit_single_precision(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) {
    return std::abs(v) <= 3.4028234663852886e38 && static_cast<double>(static_cast<float>(v)) == v;
  });
}

std::vector<std::uint64_t> unpack_words(const PackedView& packed, std::uint64_t count, const char* what) {
  if (packed.count != count)
    damaged(fmt::format("{} has {} numbers where the model needs {}", what, packed.count, count), what);
  const std::size_t width = packed.width;
  if (width != 1 && width != 2 && width != 4 && width != 8)
    damaged(fmt::format("{} has numbers of {} bytes", what, width), what);
  if (count > (std::uint64_t{1} << 40)) damaged(fmt::format("{} claims {} numbers", what, count), what);
  return unshuffle(decompress(packed.bytes, count * width, what), count, width);
}

std::vector<std::int64_t> unpack_checked_integers(const PackedView& packed, std::uint64_t count, const char* what) {
  const std::vector<std::uint64_t> words = unpack_words(packed, count, what);
  std::vector<std::int64_t> values(words.size());
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::uint64_t v = unzigzag(words[i]);
    if (packed.differences) v += before;
    before = v;
    values[i] = static_cast<std::int64_t>(v);
  }
  return values;
}

}  // namespace

std::string compress(std::string_view bytes) {
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // there is room for the bound: only zstd's own memory can be missing
  frame.resize(size);
  return frame;
}

std::string decompress(std::string_view frame, std::uint64_t size, const char* what) {
  // A block of at most 128 kB takes at least 4 bytes, so this is the most that a frame of that length can hold.
  if (size > (frame.size() / 4 + 1) * (std::uint64_t{128} << 10))
    damaged(fmt::format("{} should be {} bytes, more than its {} compressed bytes can hold", what, size, frame.size()),
            what);
  const unsigned long long stated = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (stated != size || ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size())
    damaged(fmt::format("{} is not one zstd frame of {} bytes", what, size), what);
  std::string bytes(size, '\0');
  const std::size_t got = ZSTD_decompress(bytes.data(), bytes.size(), frame.data(), frame.size());
  if (ZSTD_isError(got)) damaged(fmt::format("{} cannot be decompressed: {}", what, ZSTD_getErrorName(got)), what);
  assert(got == size);  // zstd holds a frame to the size that it states
  return bytes;
}

PackedNumbers pack_integers(std::span<const std::int64_t> values) {
  std::vector<std::uint64_t> plain(values.size()), differences(values.size());
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto v = static_cast<std::uint64_t>(values[i]);
    plain[i] = zigzag(v);
    differences[i] = zigzag(v - before);
    before = v;
  }
  PackedNumbers a = pack_coded(differences, true), b = pack_coded(plain, false);
  return a.bytes.size() < b.bytes.size() ? std::move(a) : std::move(b);
}

PackedNumbers pack_reals(std::span<const double> values) {
  for (int decimals = 0; decimals <= kMostDecimals; ++decimals)
    if (const auto integers = as_integers(values, kPowersOfTen[static_cast<std::size_t>(decimals)])) {
      PackedNumbers packed = pack_integers(*integers);
      packed.decimals = static_cast<std::uint8_t>(decimals);
      return packed;
    }
  std::vector<std::uint64_t> words(values.size());
  if (fit_single_precision(values)) {
    std::transform(values.begin(), values.end(), words.begin(),
                   [](double v) { return std::bit_cast<std::uint32_t>(static_cast<float>(v)); });
    return {values.size(), NumberForm::real32, 4, false, 0, compress(shuffle(words, 4))};
  }
  std::transform(values.begin(), values.end(), words.begin(), [](double v) { return std::bit_cast<std::uint64_t>(v); });
  return {values.size(), NumberForm::real64, 8, false, 0, compress(shuffle(words, 8))};
}

std::vector<std::int64_t> unpack_integers(const PackedView& packed, std::uint64_t count, const char* what) {
  if (packed.form != NumberForm::integers || packed.decimals != 0)
    damaged(fmt::format("{} is not stored as integers", what), what);
  return unpack_checked_integers(packed, count, what);
}

std::vector<double> unpack_reals(const PackedView& packed, std::uint64_t count, const char* what) {
  std::vector<double> values;
  if (packed.form == NumberForm::integers) {
    if (packed.decimals > kMostDecimals) damaged(fmt::format("{} has {} decimals", what, packed.decimals), what);
    const std::vector<std::int64_t> integers = unpack_checked_integers(packed, count, what);
    const double power = kPowersOfTen[packed.decimals];
    values.resize(integers.size());
    std::transform(integers.begin(), integers.end(), values.begin(),
                   [power](std::int64_t v) { return static_cast<double>(v) / power; });
    return values;
  }
  const bool single = packed.form == NumberForm::real32;
  if (!single && packed.form != NumberForm::real64)
    damaged(fmt::format("{} is stored in a form that this Retalho does not know", what), what);
  if (packed.width != (single ? 4 : 8)) damaged(fmt::format("{} has reals of {} bytes", what, packed.width), what);
  const std::vector<std::uint64_t> words = unpack_words(packed, count, what);
  values.resize(words.size());
  if (single)
    std::transform(words.begin(), words.end(), values.begin(), [](std::uint64_t w) {
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(w)));
    });
  else
    std::transform(words.begin(), words.end(), values.begin(),
                   [](std::uint64_t w) { return std::bit_cast<double>(w); });
  return values;
}

}  // namespace retalho
