// Points as text: one a line.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "retalho/cloud/formats.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string_view trim(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string_view unquoted(std::string_view text) {
  text = trim(text);
  if (text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front())
    text = trim(text.substr(1, text.size() - 2));
  return text;
}

/// A number; NaN for the usual words for "none" and for an empty field; nothing for anything else.
std::optional<double> number(std::string_view field) {
  field = unquoted(field);
  if (field.empty()) return kNaN;
  std::string_view digits = field;
  if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-' && digits[1] != '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end == digits.data() + digits.size()) {
    if (error == std::errc()) return value;
    if (error == std::errc::result_out_of_range) {  // 1e-400 is zero, 1e400 is not a height
      const std::size_t e = digits.find_first_of("eE");
      return e != std::string_view::npos && e + 1 < digits.size() && digits[e + 1] == '-' ? 0.0 : kNaN;
    }
  }
  const std::string word = lower(field);
  for (const char* none : {"na", "n/a", "null", "none", "nodata", "no data", "-", "*", "-nan", "1.#qnan", "-1.#ind"})
    if (word == none) return kNaN;
  return std::nullopt;
}

bool has_decimal_comma(std::string_view field) {
  const std::size_t comma = field.find(',');
  if (comma == std::string_view::npos || comma == 0 || comma + 1 >= field.size()) return false;
  return std::isdigit(static_cast<unsigned char>(field[comma - 1])) &&
         std::isdigit(static_cast<unsigned char>(field[comma + 1]));
}

void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') {
    for (std::size_t at = 0; at < line.size();) {
      while (at < line.size() && (line[at] == ' ' || line[at] == '\t')) ++at;
      const std::size_t start = at;
      while (at < line.size() && line[at] != ' ' && line[at] != '\t') ++at;
      if (at > start) fields.push_back(line.substr(start, at - start));
    }
    return;
  }
  for (;;) {
    const std::size_t at = line.find(separator);
    fields.push_back(trim(line.substr(0, at)));
    if (at == std::string_view::npos) break;
    line.remove_prefix(at + 1);
  }
}

/// ';' before tab before ',' before blanks: commas only where they stand between values and not inside them.
char choose_separator(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ';';
  std::vector<std::string_view> fields;
  if (line.find(',') != std::string_view::npos) {
    split(line, ',', fields);
    // Several words in one field: blanks separate, and the commas are decimal ones ("1,5 2,5 3,0").
    const bool several = std::any_of(fields.begin(), fields.end(), [](std::string_view field) {
      return unquoted(field) == field && field.find_first_of(" \t") != std::string_view::npos &&
             number(field.substr(0, field.find_first_of(" \t"))).has_value();
    });
    if (!several) return ',';
  }
  return line.find('\t') != std::string_view::npos && line.find(' ') == std::string_view::npos ? '\t' : ' ';
}

struct Columns {
  std::array<std::size_t, 6> index{0, 1, 2, 3, 4, 5};  // x, y, z, nx, ny, nz
  std::size_t count = 3;                               // 3, or 6 with normals
  bool named = false;
};

Columns find_columns(const std::vector<std::string_view>& names) {
  static const std::array<std::vector<const char*>, 6> known{{
      {"x", "lon", "long", "longitude", "easting", "east", "e", "x_coord", "xcoord", "//x"},
      {"y", "lat", "latitude", "northing", "north", "n", "y_coord", "ycoord"},
      {"z", "height", "elevation", "elev", "alt", "altitude", "depth", "h", "z_coord", "zcoord"},
      {"nx", "normal_x", "normalx"},
      {"ny", "normal_y", "normaly"},
      {"nz", "normal_z", "normalz"},
  }};
  Columns columns;
  std::array<bool, 6> found{};
  for (std::size_t which = 0; which < 6; ++which)
    for (const char* name : known[which])
      for (std::size_t k = 0; k < names.size() && !found[which]; ++k)
        if (lower(unquoted(names[k])) == name) {
          columns.index[which] = k;
          found[which] = true;
        }
  columns.named = found[0] && found[1] && found[2];
  if (!columns.named) return {};
  columns.count = found[3] && found[4] && found[5] ? 6 : 3;
  return columns;
}

class Parser {
 public:
  Parser(const std::string& name, PointCloud& cloud, PointNotes& notes) : name_(name), cloud_(cloud), notes_(notes) {}

  void line(std::string_view text) {
    ++line_;
    if (const std::size_t hash = text.find('#'); hash != std::string_view::npos) {
      if (!started_) header_comment_ = trim(text.substr(hash + 1));
      text = text.substr(0, hash);
    }
    text = trim(text);
    if (text.empty() || text.front() == '%' || text.front() == '>' || text.starts_with("//")) return;
    if (!started_ && !begin(text)) return;
    split(text, separator_, fields_);
    point();
  }

  void finish() {
    if (!started_) throw BadInput(fmt::format("'{}' holds no line with three numbers", name_), name_);
    if (columns_.count == 6 && !columns_.named && !unit_normals_) {
      cloud_.normals = {};
      columns_.count = 3;
    }
    notes_.format = "text";
    notes_.columns = fmt::format("{}{} of {} column{}", "x, y, z", columns_.count == 6 ? ", normals" : "", width_,
                                 width_ == 1 ? "" : "s");
    if (notes_.skipped > 0)
      notes_.remarks.push_back(fmt::format("{} lines without finite coordinates are left out (the first: line {})",
                                           notes_.skipped, first_skipped_));
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw CannotRead(fmt::format("'{}', line {}: {}", name_, line_, what), name_, fmt::format("line {}", line_));
  }

  /// The first line that is no comment: a header, a count, or the first point. True when it is a point.
  bool begin(std::string_view text) {
    const char separator = choose_separator(text);
    split(text, separator, fields_);
    const auto is_number = [](std::string_view field) { return number(field).has_value() && !unquoted(field).empty(); };
    const auto numbers = static_cast<std::size_t>(std::count_if(fields_.begin(), fields_.end(), is_number));
    if (numbers < 3) {
      refuse_decimal_commas();
      if (header_lines_ > 20) fail("no points after 20 lines: this is not a table of x, y, z");
      ++header_lines_;
      if (fields_.size() == 1 && numbers == 1) return false;  // a count, as .pts files begin with
      if (fields_.size() == 2 && numbers == 2)
        throw BadInput(fmt::format("'{}', line {}: two numbers; a point needs x, y and z", name_, line_), name_,
                       fmt::format("line {}", line_));
      columns_ = find_columns(fields_);
      return false;
    }
    if (!columns_.named && !header_comment_.empty()) {
      std::vector<std::string_view> names;
      split(header_comment_, choose_separator(header_comment_), names);
      if (names.size() == fields_.size()) columns_ = find_columns(names);
    }
    started_ = true;
    separator_ = separator;
    if (!columns_.named && fields_.back().empty()) fields_.pop_back();  // a separator at the end of the line
    width_ = fields_.size();
    if (!columns_.named && width_ >= 6) columns_.count = 6;
    const auto end = columns_.index.begin() + static_cast<std::ptrdiff_t>(columns_.count);
    if (const std::size_t last = *std::max_element(columns_.index.begin(), end); last >= width_)
      fail(fmt::format("{} values, but the header names x, y or z in column {}", width_, last + 1));
    return true;
  }

  void refuse_decimal_commas() const {
    for (const std::string_view field : fields_)
      if (has_decimal_comma(field) && separator_like_number(field))
        throw BadInput(fmt::format("'{}', line {}: '{}' has a decimal comma: write numbers with a point ({})", name_,
                                   line_, field, with_point(field)),
                       name_, fmt::format("line {}", line_));
  }
  static bool separator_like_number(std::string_view field) {
    return field.find_first_not_of("+-0123456789,.eE") == std::string_view::npos;
  }
  static std::string with_point(std::string_view field) {
    std::string text(field);
    std::replace(text.begin(), text.end(), ',', '.');
    return text;
  }

  void point() {
    if (fields_.size() == width_ + 1 && fields_.back().empty()) fields_.pop_back();
    if (fields_.size() != width_) {
      refuse_decimal_commas();
      fail(fmt::format("{} values, where the first point has {}", fields_.size(), width_));
    }
    std::array<double, 6> v{};
    bool finite = true;
    for (std::size_t k = 0; k < columns_.count; ++k) {
      const std::string_view field = fields_[columns_.index[k]];
      const auto value = number(field);
      if (!value) {
        refuse_decimal_commas();
        if (k >= 3 && !columns_.named) {  // a word in column 4 to 6: no normals in this file
          columns_.count = 3;
          cloud_.normals = {};
          break;
        }
        fail(fmt::format("'{}' is not a number", field.substr(0, 40)));
      }
      v[k] = *value;
      finite = finite && (k >= 3 || std::isfinite(*value));
    }
    if (!finite) {
      if (notes_.skipped++ == 0) first_skipped_ = line_;
      return;
    }
    cloud_.positions.push_back({v[0], v[1], v[2]});
    if (columns_.count < 6) return;
    const Vec3 normal{v[3], v[4], v[5]};
    if (!(std::abs(norm(normal) - 1) < 0.05)) unit_normals_ = false;
    cloud_.normals.push_back(normal);
  }

  const std::string& name_;
  PointCloud& cloud_;
  PointNotes& notes_;
  std::vector<std::string_view> fields_;
  std::string header_comment_;
  Columns columns_;
  char separator_ = ' ';
  std::size_t line_ = 0, width_ = 0, first_skipped_ = 0;
  int header_lines_ = 0;
  bool started_ = false, unit_normals_ = true;
};

}  // namespace

void parse_text_points(const std::string& text, const std::string& name, PointCloud& cloud, PointNotes& notes,
                       const Context& context) {
  std::string_view rest = text;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  if (rest.starts_with("\xFF\xFE") || rest.starts_with("\xFE\xFF"))
    throw CannotRead(fmt::format("'{}' is UTF-16 text: save it as UTF-8 or ASCII", name), name);
  if (rest.substr(0, 4096).find('\0') != std::string_view::npos)
    throw CannotRead(fmt::format("'{}' is not text: it holds zero bytes", name), name);
  Parser parser(name, cloud, notes);
  for (std::size_t lines = 0; !rest.empty(); ++lines) {
    if (lines % 4096 == 0) {
      context.check();
      context.report("read", 1 - static_cast<double>(rest.size()) / static_cast<double>(text.size()));
    }
    const std::size_t end = rest.find_first_of("\n\r");
    parser.line(rest.substr(0, end));
    if (end == std::string_view::npos) break;
    const bool pair = rest[end] == '\r' && end + 1 < rest.size() && rest[end + 1] == '\n';
    rest.remove_prefix(end + (pair ? 2 : 1));
  }
  parser.finish();
}

void read_text_points(const std::string& path, PointCloud& cloud, PointNotes& notes, const Context& context) {
  parse_text_points(read_file(path), path, cloud, notes, context);
}

}  // namespace retalho
