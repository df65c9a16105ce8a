// The words of an error, for tests that check what the user is told.
#pragma once

#include <gtest/gtest.h>

#include <exception>
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

}  // namespace retalho::test
