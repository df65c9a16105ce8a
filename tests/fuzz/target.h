// What the fuzz targets share: a reader may refuse its input with an Error of ours, and may do nothing else wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "retalho/core/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace retalho::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Ends the program with words: libFuzzer keeps the input that led here.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

/// Runs `reader`; errors for the caller's sake (bad input, cannot read) are what it is for. One without words, or an
/// error that blames the program, is a fault.
template <class Reader>
int refuse_or(const Reader& reader) {
  try {
    reader();
  } catch (const Error& error) {
    require(error.kind() == Error::Kind::bad_input || error.kind() == Error::Kind::cannot_read ||
                error.kind() == Error::Kind::usage,
            error.what());
    require(std::string_view(error.what()).size() > 8, "an error without words");
  }
  return 0;
}

}  // namespace retalho::fuzz
