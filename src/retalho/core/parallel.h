// Parallel loops over index ranges. The chunks are fixed by `grain` alone, never by the number of threads, so a loop
// whose chunks write to places of their own (or whose partial results are combined in chunk order) gives the same
// bytes from any number of threads. oneTBB stands behind this header and nowhere else.
#pragma once

#include <cstddef>
#include <functional>

#include "retalho/core/context.h"

namespace retalho {

/// Runs `body(begin, end)` for consecutive chunks of [0, count) of `grain` indices (the last may be shorter).
/// Exceptions thrown by a body are rethrown in the caller. Checks `context.cancel` before each chunk.
/// With one thread the chunks run in order in the calling thread.
void parallel_chunks(std::size_t count, std::size_t grain, const Context& context,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// How many threads `context` means on this machine (at least 1).
int thread_count(const Context& context);

}  // namespace retalho
