#include "checks.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace retalho::app {
namespace {

CLI::Validator at_least(bool zero, const char* description, const char* words) {
  return CLI::Validator(
      [zero, words](const std::string& text) -> std::string {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        const bool good =
            end != text.c_str() && *end == '\0' && std::isfinite(value) && (value > 0 || (zero && value == 0));
        return good ? std::string() : fmt::format("'{}' is not a number {}", text, words);
      },
      description);
}

}  // namespace

CLI::Validator above_zero() {
  return at_least(false, "POSITIVE", "above 0");
}

CLI::Validator zero_or_more() {
  return at_least(true, "NONNEGATIVE", "of 0 or more");
}

}  // namespace retalho::app
