// Formulas, and that their enclosures hold the values.
#include <cmath>

#include "retalho/curve/expression.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] {
    if (size > 400) return;  // muParserX is slow on long ones
    const Expression f = Expression::parse(std::string(fuzz::text_of(data, size)));
    for (const double x : {-1.5, 0.0, 0.75, 1e30}) {
      const double value = f(x, 0.25);
      const IntervalJet box = f.enclose({x, x}, {0.25, 0.25});
      fuzz::require(!box.defined || !std::isfinite(value) || (box.value.low <= value && value <= box.value.high),
                    "an enclosure without the value");
    }
  });
}
