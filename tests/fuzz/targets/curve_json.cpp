// Curves as JSON, and the curves that they make.
#include <tuple>

#include "retalho/curve/document.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] {
    const CurveDocument document = parse_curves(fuzz::text_of(data, size), "fuzz.json");
    // What was read is written and read again as the same.
    const std::string once = to_json(document);
    fuzz::require(to_json(parse_curves(once, "again.json")) == once, "a document that changes when it is read again");
    for (const CurveSpec& spec : document.curves) {
      if (spec.kind == CurveKind::implicit_form || spec.kind == CurveKind::explicit_form) continue;
      if (spec.points.size() > 64) continue;
      std::ignore = to_curve(spec);
    }
  });
}
