// How much memory there is, so that an absurd claim in a file is refused before anything is allocated.
#pragma once

#include <cstdint>

namespace retalho {

/// Bytes that this process can still take without swapping: the least of what the machine has available, what the
/// address-space limit leaves and what the control group leaves. The largest number when nothing can be learnt.
std::uint64_t available_memory();

}  // namespace retalho
