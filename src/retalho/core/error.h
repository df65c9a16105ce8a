// Errors by cause. Every message says what was wrong, where, and what to do; app/main.cpp turns the kind into an
// exit code (docs/cli.md) and into the JSON error object. The same names are used in Python.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace retalho {

/// Base of everything that Retalho throws on purpose.
class Error : public std::runtime_error {
 public:
  enum class Kind { internal = 1, usage = 2, bad_input = 3, cannot_read = 4, cannot_write = 5, interrupted = 130 };

  /// `file` and `where` (a line, a cell, a field) may be empty.
  Error(Kind kind, const std::string& message, std::string file = {}, std::string where = {})
      : std::runtime_error(message), kind_(kind), file_(std::move(file)), where_(std::move(where)) {}

  Kind kind() const { return kind_; }
  int exit_code() const { return static_cast<int>(kind_); }
  const std::string& file() const { return file_; }
  const std::string& where() const { return where_; }

 private:
  Kind kind_;
  std::string file_;
  std::string where_;
};

/// Stable lower-case name of a kind ("bad_input"), as in JSON.
const char* kind_name(Error::Kind kind);

/// Options that contradict each other or are out of range.
struct UsageError : Error {
  explicit UsageError(const std::string& m, std::string file = {}, std::string where = {})
      : Error(Kind::usage, m, std::move(file), std::move(where)) {}
};
/// The input can be read, but not used: wrong content.
struct BadInput : Error {
  explicit BadInput(const std::string& m, std::string file = {}, std::string where = {})
      : Error(Kind::bad_input, m, std::move(file), std::move(where)) {}
};
/// The file is missing, unreadable, of an unknown format or damaged.
struct CannotRead : Error {
  explicit CannotRead(const std::string& m, std::string file = {}, std::string where = {})
      : Error(Kind::cannot_read, m, std::move(file), std::move(where)) {}
};
/// The output cannot be made: exists, no room, no permission, no such driver.
struct CannotWrite : Error {
  explicit CannotWrite(const std::string& m, std::string file = {}, std::string where = {})
      : Error(Kind::cannot_write, m, std::move(file), std::move(where)) {}
};
/// The caller asked to stop (Context::cancel).
struct Interrupted : Error {
  Interrupted() : Error(Kind::interrupted, "interrupted") {}
};

}  // namespace retalho
