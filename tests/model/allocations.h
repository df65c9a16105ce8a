// The largest single allocation of this test program since it was last set to 0.
#pragma once

#include <cstddef>

namespace retalho::test {
extern std::size_t largest_allocation;
}
