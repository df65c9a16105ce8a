#include "retalho/model/byte_stream.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr std::uint64_t zigzag(std::int64_t v) {
  return static_cast<std::uint64_t>(v) << 1 ^ static_cast<std::uint64_t>(v >> 63);
}
constexpr std::int64_t unzigzag(std::uint64_t v) {
  return static_cast<std::int64_t>(v >> 1) ^ -static_cast<std::int64_t>(v & 1);
}

double parse(std::int64_t digits, int exponent, bool& fine) {
  const std::string text = fmt::format("{}e{}", digits, exponent);
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  fine = result.ec == std::errc() && std::isfinite(value);
  return value;
}

}  // namespace

void ByteWriter::varint(std::uint64_t value) {
  for (; value >= 128; value >>= 7) byte(static_cast<std::uint8_t>(value & 127) | 128);
  byte(static_cast<std::uint8_t>(value));
}

void ByteWriter::real(double value) {
  if (value == 0) {  // both zeros: no header tells them apart
    byte(0);
    return;
  }
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific).ptr;
  // d.ddde+xx: the digits without their point, and the power of ten of the last one
  std::int64_t digits = 0;
  int exponent = 0;
  const char* at = text + (text[0] == '-' ? 1 : 0);
  bool point = false;
  for (; *at != 'e'; ++at) {
    if (*at == '.') {
      point = true;
      continue;
    }
    digits = digits * 10 + (*at - '0');
    if (point) --exponent;
  }
  ++at;
  int power = 0;
  std::from_chars(at + (*at == '+' ? 1 : 0), end, power);
  exponent += power;
  varint(zigzag(text[0] == '-' ? -digits : digits));
  varint(zigzag(exponent));
}

void ByteWriter::text(std::string_view value) {
  varint(value.size());
  bytes_.append(value);
}

std::uint8_t ByteReader::byte(const char* what) {
  if (bytes_.empty()) throw CannotRead(fmt::format("the header ends before its {}", what), {}, what);
  const auto value = static_cast<std::uint8_t>(bytes_.front());
  bytes_.remove_prefix(1);
  return value;
}

std::uint64_t ByteReader::varint(const char* what) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const std::uint8_t next = byte(what);
    value |= std::uint64_t{next & 127U} << shift;
    if (next < 128) return value;
  }
  throw CannotRead(fmt::format("the header's {} is no number", what), {}, what);
}

double ByteReader::real(const char* what) {
  const std::int64_t digits = unzigzag(varint(what));
  if (digits == 0) return 0;
  const std::int64_t exponent = unzigzag(varint(what));
  bool fine = exponent > -400 && exponent < 400;
  const double value = fine ? parse(digits, static_cast<int>(exponent), fine) : 0;
  if (!fine) throw CannotRead(fmt::format("the header's {} is no finite number", what), {}, what);
  return value;
}

std::string ByteReader::text(const char* what) {
  const std::uint64_t size = varint(what);
  if (size > bytes_.size())
    throw CannotRead(fmt::format("the header's {} of {} bytes does not fit", what, size), {}, what);
  std::string value(bytes_.substr(0, size));
  bytes_.remove_prefix(size);
  return value;
}

}  // namespace retalho
