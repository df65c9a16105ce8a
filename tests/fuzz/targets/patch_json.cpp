// Triangular patches as JSON.
#include "retalho/patch/document.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] { parse_patches(fuzz::text_of(data, size), "fuzz.json"); });
}
