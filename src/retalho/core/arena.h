// Internal to core/: oneTBB's arenas. No header outside of core/ includes it.
#pragma once

#include <tbb/task_arena.h>

namespace retalho {

/// The arena of that many threads, made once: making one a call costs milliseconds and memory. oneTBB also has to be
/// told that more threads than cores are wanted, or it says so on standard error and runs fewer.
tbb::task_arena& arena_of(int threads);

}  // namespace retalho
