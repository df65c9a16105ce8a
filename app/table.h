// A small table for people (aligned text), for the docs (Markdown) and for other programs (CSV).
#pragma once

#include <string>
#include <vector>

namespace retalho::app {

class Table {
 public:
  explicit Table(std::vector<std::string> header) : header_(std::move(header)) {}

  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  /// The first column to the left, the others to the right; two spaces between.
  std::string text() const;
  std::string markdown() const;
  /// RFC 4180: values with a comma, a quote or a line end are quoted.
  std::string csv() const;

 private:
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

/// Names with values, one a line, values aligned.
std::string list_text(const std::vector<std::pair<std::string, std::string>>& entries);

/// Six significant digits, without trailing zeros; "no data" for NaN.
std::string number_text(double value);

}  // namespace retalho::app
