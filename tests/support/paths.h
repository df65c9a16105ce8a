// Where the checkout and the built program lie. Only paths.cpp is compiled with these paths: the tests' other objects
// are the same in every checkout, so a compiler cache serves them all. Include as "support/paths.h".
#pragma once

#include <string>

namespace retalho::test {

/// The checkout's folder, absolute, without a slash at its end.
std::string source_folder();

/// The path of the program under test.
std::string program_path();

}  // namespace retalho::test
