// Work that is made in parallel and taken in order, so that results may leave while others are in the making. oneTBB
// stands behind this header as behind core/parallel.h.
#pragma once

#include <cstddef>
#include <functional>

#include "retalho/core/context.h"

namespace retalho {

/// Runs make(i, slot) for every i in [0, count) on all threads, and take(i, slot) in the calling thread for i
/// ascending, each after its make. `slot` < slot_count(context) is where make leaves what take reads: no two that are
/// under way share one, so no more than so many results wait. Exceptions of both are rethrown in the caller, after all
/// that runs has ended. Checks `context.cancel` before each make.
void parallel_in_order(std::size_t count, const Context& context,
                       const std::function<void(std::size_t i, std::size_t slot)>& make,
                       const std::function<void(std::size_t i, std::size_t slot)>& take);

/// Slots of parallel_in_order: 1 for one thread.
std::size_t slot_count(const Context& context);

}  // namespace retalho
