#include "retalho/model/envelope.h"

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include <memory>

#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr std::string_view kSignature("\x89RTLO\r\n\x1a", 8);
constexpr std::size_t kHashAt = 24;

void put(std::string& out, std::uint64_t value, std::size_t bytes) {
  for (std::size_t k = 0; k < bytes; ++k) out.push_back(static_cast<char>((value >> (8 * k)) & 0xff));
}

std::uint64_t get(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < size; ++k) value |= std::uint64_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return value;
}

std::uint64_t checksum(std::string_view head, std::string_view content) {
  const std::unique_ptr<XXH64_state_t, decltype(&XXH64_freeState)> state(XXH64_createState(), &XXH64_freeState);
  XXH64_reset(state.get(), 0);
  XXH64_update(state.get(), head.data(), head.size());
  XXH64_update(state.get(), content.data(), content.size());
  return XXH64_digest(state.get());
}

}  // namespace

bool has_signature(std::string_view bytes) {
  return bytes.starts_with(kSignature);
}

std::string seal(std::string_view content) {
  std::string out(kSignature);
  out.reserve(kEnvelopeSize + content.size());
  put(out, kFormatMajor, 2);
  put(out, kFormatMinor, 2);
  put(out, 0, 4);
  put(out, kEnvelopeSize + content.size(), 8);
  put(out, checksum(out, content), 8);
  out.append(content);
  return out;
}

Envelope unseal(std::string_view bytes) {
  if (bytes.empty()) throw CannotRead("the file is empty");
  if (!has_signature(bytes)) {
    if (kSignature.starts_with(bytes))
      throw CannotRead(fmt::format("the file ends after {} bytes, within its signature", bytes.size()), {},
                       "signature");
    throw CannotRead("not a Retalho model: it does not begin with the signature of one", {}, "signature");
  }
  if (bytes.size() < kEnvelopeSize)
    throw CannotRead(
        fmt::format("the file ends after {} bytes, within its {} bytes of header", bytes.size(), kEnvelopeSize), {},
        "header");
  Envelope envelope;
  envelope.major = static_cast<std::uint16_t>(get(bytes, 8, 2));
  envelope.minor = static_cast<std::uint16_t>(get(bytes, 10, 2));
  if (envelope.major > kFormatMajor)
    throw CannotRead(
        fmt::format("written by a newer Retalho (format {}; this one reads up to {}), or damaged: update Retalho",
                    envelope.major, kFormatMajor),
        {}, "format");
  const std::uint64_t size = get(bytes, 16, 8);
  if (size > bytes.size())
    throw CannotRead(fmt::format("the file ends after {} of {} bytes: it was cut short", bytes.size(), size), {},
                     "size");
  if (size != bytes.size())
    throw CannotRead(fmt::format("the file has {} bytes and should have {}", bytes.size(), size), {}, "size");
  envelope.content = bytes.substr(kEnvelopeSize);
  if (get(bytes, kHashAt, 8) != checksum(bytes.substr(0, kHashAt), envelope.content))
    throw CannotRead("damaged: the checksum does not fit the content", {}, "checksum");
  if (envelope.major != kFormatMajor || get(bytes, 12, 4) != 0)
    throw CannotRead(fmt::format("there is no format {}", envelope.major), {}, "format");
  return envelope;
}

}  // namespace retalho
