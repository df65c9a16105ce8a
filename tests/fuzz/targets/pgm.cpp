// ASCII PGM.
#include <algorithm>
#include <cstring>

#include "retalho/raster/pgm.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] {
    std::string_view rest = fuzz::text_of(data, size);
    const Raster raster = read_pgm(
        [&](char* to, std::size_t room) {
          const std::size_t n = std::min(room, rest.size());
          std::memcpy(to, rest.data(), n);
          rest.remove_prefix(n);
          return n;
        },
        "fuzz.pgm", {}, size);
    fuzz::require(raster.columns > 0 && raster.rows > 0, "a grid without cells");
    fuzz::require(raster.cells() <= size, "more cells than bytes");
  });
}
