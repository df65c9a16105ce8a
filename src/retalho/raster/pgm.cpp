#include "retalho/raster/pgm.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <optional>

#include "retalho/core/error.h"
#include "retalho/raster/claim.h"
#include "retalho/raster/height_sink.h"

namespace retalho {
namespace {

constexpr std::uint64_t kLargest = std::uint64_t{1} << 53;  // beyond, double is not exact

class Tokens {
 public:
  Tokens(const ByteSource& source, const std::string& name) : source_(source), name_(name), buffer_(1 << 16, '\0') {}

  int peek() {
    if (at_ == end_) {
      if (finished_) return -1;
      at_ = 0;
      end_ = source_(buffer_.data(), buffer_.size());
      if (end_ == 0) {
        finished_ = true;
        return -1;
      }
    }
    return static_cast<unsigned char>(buffer_[at_]);
  }
  int next() {
    const int c = peek();
    if (c < 0) return c;
    ++at_;
    if (c == '\n') ++line_;
    return c;
  }
  void skip_blanks() {
    for (int c = peek(); c >= 0; c = peek()) {
      if (c == '#') {
        while (c >= 0 && c != '\n' && c != '\r') c = next();
      } else if (c == ' ' || (c >= '\t' && c <= '\r')) {
        next();
      } else {
        return;
      }
    }
  }
  /// The next unsigned number, or nothing at the end of the file. `what` names it in errors.
  template <class What>
  std::optional<std::uint64_t> number(const What& what) {
    skip_blanks();
    if (peek() < 0) return std::nullopt;
    std::uint64_t value = 0;
    int digits = 0;
    for (int c = peek(); c >= '0' && c <= '9'; c = peek(), ++digits) {
      value = value * 10 + static_cast<std::uint64_t>(c - '0');
      if (value > kLargest) fail(fmt::format("{} is larger than 2^53", what()));
      next();
    }
    const int c = peek();
    const bool ends = c < 0 || c == ' ' || c == '#' || (c >= '\t' && c <= '\r');
    if (digits == 0 || !ends) {
      const std::string seen =
          c >= 32 && c < 127 ? fmt::format("'{}'", static_cast<char>(c)) : fmt::format("byte {}", c);
      fail(fmt::format("{} should be a whole number of digits, but has {}", what(), seen));
    }
    return value;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw CannotRead(fmt::format("'{}', line {}: {}", name_, line_, what), name_, fmt::format("line {}", line_));
  }

 private:
  const ByteSource& source_;
  const std::string& name_;
  std::string buffer_;
  std::size_t at_ = 0, end_ = 0, line_ = 1;
  bool finished_ = false;
};

std::uint64_t header_number(Tokens& tokens, const char* what, std::uint64_t largest) {
  const auto value = tokens.number([what] { return what; });
  if (!value) tokens.fail(fmt::format("the file ends before {}", what));
  if (*value == 0 || *value > largest)
    tokens.fail(fmt::format("{} is {}; it should be 1 to {}", what, *value, largest));
  return *value;
}

}  // namespace

Raster read_pgm(const ByteSource& source, const std::string& name, const Context& context,
                std::optional<std::uint64_t> size) {
  Tokens tokens(source, name);
  const int first = tokens.next(), second = tokens.next(), third = tokens.peek();
  if (first != 'P' || second != '2' || !(third == '#' || third == ' ' || (third >= '\t' && third <= '\r')))
    tokens.fail("not an ASCII PGM: it should begin with P2 and white space");

  Raster raster;
  constexpr auto kSide = static_cast<std::uint64_t>(std::numeric_limits<int>::max());
  raster.columns = static_cast<int>(header_number(tokens, "the width", kSide));
  raster.rows = static_cast<int>(header_number(tokens, "the height", kSide));
  const std::uint64_t maximum = header_number(tokens, "the largest value (maxval)", kLargest);
  // A sample takes a digit and the white space before it.
  if (size && raster.cells() > *size / 2)
    tokens.fail(fmt::format("{} x {} samples do not fit into {} bytes: the file is cut off, or its size line is wrong",
                            raster.columns, raster.rows, *size));
  check_claim(raster.columns, raster.rows, maximum <= (1U << 24) ? sizeof(float) : sizeof(double), name);

  HeightSink sink(raster.cells());
  for (int row = 0; row < raster.rows; ++row) {
    context.check();
    for (int column = 0; column < raster.columns; ++column) {
      const auto what = [&] { return fmt::format("the sample at column {}, row {}", column, row); };
      const auto value = tokens.number(what);
      if (!value)
        tokens.fail(fmt::format(
            "the file ends at sample {} of {} (column {}, row {}): it is cut off, or its size line is wrong",
            sink.size(), raster.cells(), column, row));
      if (*value > maximum)
        tokens.fail(fmt::format("{} is {}, above the largest value {} that the header gives", what(), *value, maximum));
      sink.add(static_cast<double>(*value));
    }
    context.report("read", static_cast<double>(row + 1) / raster.rows);
  }
  tokens.skip_blanks();
  if (tokens.peek() >= 0)
    tokens.fail(
        fmt::format("something follows the last of the {} x {} samples: the size line is wrong, or the file is damaged",
                    raster.columns, raster.rows));
  raster.heights = sink.take();
  return raster;
}

}  // namespace retalho
