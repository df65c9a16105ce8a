#include "calls.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "retalho/core/error.h"

namespace retalho::viewer {
namespace {

const Json& value(const Json& input, const char* key) {
  const auto at = input.find(key);
  if (at == input.end()) throw BadInput(fmt::format("the call lacks '{}'", key), {}, key);
  return *at;
}

std::size_t size_of(const std::string& type) {
  return type == "f64" ? 8 : type == "u8" ? 1 : 4;
}

}  // namespace

std::string pack(const Answer& answer) {
  Json list = Json::array();
  const auto padded = [](std::size_t n) { return (n + 7) / 8 * 8; };
  // The offsets are counted from the first array, so that the header's own length does not matter.
  std::size_t at = 0;
  for (const Array& array : answer.arrays) {
    list.push_back({{"name", array.name},
                    {"type", array.type},
                    {"offset", at},
                    {"count", array.bytes.size() / size_of(array.type)}});
    at += padded(array.bytes.size());
  }
  const std::string header =
      Json{{"words", answer.words}, {"arrays", list}}.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out = "RTL1";
  const auto length = static_cast<std::uint32_t>(header.size());
  out.append(reinterpret_cast<const char*>(&length), 4);
  out.reserve(padded(8 + header.size()) + at);
  out += header;
  out.resize(padded(out.size()), ' ');
  for (const Array& array : answer.arrays) {
    out += array.bytes;
    out.resize(padded(out.size()), '\0');
  }
  return out;
}

double number(const Json& input, const char* key, double low, double high) {
  const Json& v = value(input, key);
  const double d = v.is_number() ? v.get<double>() : std::nan("");
  if (!(d >= low && d <= high))
    throw BadInput(fmt::format("'{}' must be a number from {:.6g} to {:.6g}", key, low, high), {}, key);
  return d;
}

double number_or(const Json& input, const char* key, double low, double high, double otherwise) {
  return input.contains(key) ? number(input, key, low, high) : otherwise;
}

std::int64_t whole(const Json& input, const char* key, std::int64_t low, std::int64_t high) {
  const double d = number(input, key, static_cast<double>(low), static_cast<double>(high));
  if (d != std::floor(d)) throw BadInput(fmt::format("'{}' must be a whole number", key), {}, key);
  return static_cast<std::int64_t>(d);
}

bool flag_or(const Json& input, const char* key, bool otherwise) {
  if (!input.contains(key)) return otherwise;
  const Json& v = value(input, key);
  if (!v.is_boolean()) throw BadInput(fmt::format("'{}' must be true or false", key), {}, key);
  return v.get<bool>();
}

std::string word(const Json& input, const char* key, const std::vector<std::string>& known) {
  const Json& v = value(input, key);
  const std::string w = v.is_string() ? v.get<std::string>() : std::string();
  if (std::find(known.begin(), known.end(), w) == known.end())
    throw BadInput(fmt::format("'{}' must be one of: {}", key, fmt::join(known, ", ")), {}, key);
  return w;
}

std::string text(const Json& input, const char* key, std::size_t longest) {
  const Json& v = value(input, key);
  if (!v.is_string() || v.get_ref<const std::string&>().size() > longest)
    throw BadInput(fmt::format("'{}' must be a text of at most {} bytes", key, longest), {}, key);
  return v.get<std::string>();
}

}  // namespace retalho::viewer
