// Sequences of numbers as few bytes, without loss: the arrays of a model file (model_file.fbs, table Numbers).
// zstd stands behind this header and nowhere else. Internal to the room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace retalho {

enum class NumberForm : std::uint8_t { integers = 0, real32 = 1, real64 = 2 };

/// Numbers written down. `Bytes` is std::string when packed here, std::string_view when read from a file.
template <typename Bytes>
struct BasicPackedNumbers {
  std::uint64_t count = 0;
  NumberForm form = NumberForm::integers;
  std::uint8_t width = 1;
  bool differences = false;
  std::uint8_t decimals = 0;
  Bytes bytes;
};
using PackedNumbers = BasicPackedNumbers<std::string>;
using PackedView = BasicPackedNumbers<std::string_view>;

/// Integers, as they are or as differences, whichever is smaller.
PackedNumbers pack_integers(std::span<const std::int64_t> values);

/// Finite reals in the smallest of: integers over a power of ten, single precision, double precision, each only where
/// it gives back every number to the bit (the sign of zero too).
PackedNumbers pack_reals(std::span<const double> values);

/// What pack_* was given. `count` is how many numbers the model needs and `what` names them in errors.
/// Throws CannotRead (with `what` in `where`) for a wrong count, an unknown form, or bytes that do not give exactly
/// that many numbers. Never allocates more than zstd can make of that many bytes, whatever the file claims.
std::vector<std::int64_t> unpack_integers(const PackedView& packed, std::uint64_t count, const char* what);
std::vector<double> unpack_reals(const PackedView& packed, std::uint64_t count, const char* what);

/// One zstd frame that states its size.
std::string compress(std::string_view bytes);
/// The `size` bytes of one such frame. Throws CannotRead as above.
std::string decompress(std::string_view frame, std::uint64_t size, const char* what);

}  // namespace retalho
