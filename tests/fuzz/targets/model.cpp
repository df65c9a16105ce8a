// Model files: as they are, and content sealed anew.
#include "retalho/model/check.h"
#include "retalho/model/envelope.h"
#include "retalho/model/model_codec.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] {
    // The first byte says whether the rest is sealed first: else the checksum would keep everything out.
    if (size == 0) return;
    const std::string_view rest = fuzz::text_of(data + 1, size - 1);
    const Model model = decode_model(data[0] % 2 == 0 ? std::string(rest) : seal(rest), "fuzz.retalho");
    const std::string fault = std::visit([](const auto& shape) { return find_fault(shape); }, model);
    fuzz::require(fault.empty(), fault.c_str());
  });
}
