// What the page can ask for: a table of calls, each a function from JSON to words and arrays, run off the server's
// thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "retalho/core/context.h"

namespace retalho::viewer {

using Json = nlohmann::ordered_json;

/// Geometry for the page: a typed array with a name.
struct Array {
  std::string name, type;  ///< "f32", "f64", "u32", "u8"
  std::string bytes;
};
template <class T>
Array make_array(const std::string& name, const std::vector<T>& values) {
  static_assert(std::is_same_v<T, float> || std::is_same_v<T, double> || std::is_same_v<T, std::uint32_t> ||
                std::is_same_v<T, std::uint8_t>);
  const char* type = std::is_same_v<T, float>           ? "f32"
                     : std::is_same_v<T, double>        ? "f64"
                     : std::is_same_v<T, std::uint32_t> ? "u32"
                                                        : "u8";
  return {name, type,
          std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T))};  // little-endian
}

struct Answer {
  Json words = Json::object();
  std::vector<Array> arrays = {};
};

struct Call {
  /// Long calls answer with server-sent events (progress, then done or failed); quick ones with the answer itself.
  enum class Kind : std::uint8_t { quick, slow } kind;
  std::function<Answer(const Json& input, const Context& context)> run;
};

/// By path, "/api/terrain/fit".
using CallTable = std::map<std::string, Call>;

/// "RTL1", the header's length (u32), the header as JSON {"words", "arrays": [{name, type, offset, count}]}, then the
/// arrays, each at a multiple of 8 from the start.
std::string pack(const Answer& answer);

// What a call was given. Each throws BadInput, which names the key, for a value that is missing, of another type, or
// out of range.
double number(const Json& input, const char* key, double low, double high);
double number_or(const Json& input, const char* key, double low, double high, double otherwise);
std::int64_t whole(const Json& input, const char* key, std::int64_t low, std::int64_t high);
bool flag_or(const Json& input, const char* key, bool otherwise);
std::string word(const Json& input, const char* key, const std::vector<std::string>& known);
std::string text(const Json& input, const char* key, std::size_t longest);

}  // namespace retalho::viewer
