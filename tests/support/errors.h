// The words of an error, for tests that check what the user is told.
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <functional>
#include <initializer_list>
#include <string>

namespace retalho::test {

/// The message of the error that `action` throws, which must be an `Expected`; a failure when it throws another or
/// none.
template <class Expected, class Action>
std::string words_of(const Action& action) {
  try {
    action();
  } catch (const Expected& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another error: " << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

/// `text` holds `part`.
inline testing::AssertionResult holds(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "'" << text << "' does not hold '" << part << "'";
}

/// A call that is refused, and a part of what is said.
struct Refused {
  const char* words;
  std::function<void()> call;
};

/// Each call throws an `Expected` that says so.
template <class Expected>
void expect_refused(std::initializer_list<Refused> rows) {
  for (const Refused& row : rows) EXPECT_TRUE(holds(words_of<Expected>(row.call), row.words));
}

}  // namespace retalho::test
