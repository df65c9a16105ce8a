// Numbers and words as bytes, the small way: for headers whose every byte counts. Internal to the room.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace retalho {

class ByteWriter {
 public:
  void byte(std::uint8_t value) { bytes_.push_back(static_cast<char>(value)); }
  /// 7 bits a byte, the lowest first.
  void varint(std::uint64_t value);
  /// A finite number by its shortest decimal digits: exponent, then digits; two bytes for 30.
  void real(double value);
  void text(std::string_view value);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Every call throws CannotRead, naming `what`, where the bytes end too early or say nothing that was written.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
  std::uint8_t byte(const char* what);
  std::uint64_t varint(const char* what);
  double real(const char* what);
  std::string text(const char* what);
  std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
};

}  // namespace retalho
