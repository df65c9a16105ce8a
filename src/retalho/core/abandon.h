// For programs that must end now, whatever their threads are at: no output is left half made.
#pragma once

#include <cstdint>

namespace retalho {

/// How many outputs have taken their names in this process (AtomicFile::commit). Lock-free: for signal handlers too.
std::uint64_t outputs_committed();

/// Removes the temporaries of all outputs in the making, and keeps every further commit waiting: end the process right
/// after it (_exit). False, with nothing done, while an output is just taking its name.
bool abandon_outputs();

}  // namespace retalho
