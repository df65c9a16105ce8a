// Quadrics as JSON.
#include "retalho/model/check.h"
#include "retalho/tetraquad/document.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] {
    if (size > 4096) return;
    const TetraQuad surface = parse_quadrics(std::string(fuzz::text_of(data, size)), "fuzz.json");
    fuzz::require(find_fault(surface).empty(), "quadrics that the model file would refuse");
  });
}
