// What stands around the content of a model file: signature, format version, size and checksum (docs/model-file.md).
// Internal to the room.
//
//   offset  bytes
//        0      8  signature 89 52 54 4C 4F 0D 0A 1A (an 8-bit byte and both line ends: text transfers show at once)
//        8      2  format, major: readers refuse a larger one
//       10      2  format, minor: readers may ignore what a larger one adds
//       12      4  zero
//       16      8  size of the file
//       24      8  XXH64 of everything else: the 24 bytes before it, then all that follow it
//       32         the content; all numbers little-endian
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace retalho {

inline constexpr std::size_t kEnvelopeSize = 32;
inline constexpr std::uint16_t kFormatMajor = 1;
inline constexpr std::uint16_t kFormatMinor = 0;

struct Envelope {
  std::uint16_t major = kFormatMajor, minor = kFormatMinor;
  std::string_view content;  ///< of the bytes given
};

std::string seal(std::string_view content);

/// Checks everything that the envelope promises. Throws CannotRead.
Envelope unseal(std::string_view bytes);

/// Do the bytes start with the signature?
bool has_signature(std::string_view bytes);

}  // namespace retalho
