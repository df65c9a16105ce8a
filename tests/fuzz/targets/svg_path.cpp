// An SVG path's data.
#include "retalho/curve/plane_path.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] { parse_svg_path(fuzz::text_of(data, size)); });
}
