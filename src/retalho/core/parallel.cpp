#include "retalho/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>

#include "retalho/core/arena.h"

namespace retalho {

tbb::task_arena& arena_of(int threads) {
  struct Pool {
    std::mutex mutex;
    std::map<int, std::unique_ptr<tbb::task_arena>> arenas;
    std::unique_ptr<tbb::global_control> control;
    int allowed = tbb::this_task_arena::max_concurrency();
  };
  static Pool pool;
  const std::lock_guard lock(pool.mutex);
  if (threads > pool.allowed) {
    pool.control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                         static_cast<std::size_t>(threads));
    pool.allowed = threads;
  }
  std::unique_ptr<tbb::task_arena>& arena = pool.arenas[threads];
  if (!arena) arena = std::make_unique<tbb::task_arena>(threads);
  return *arena;
}

int thread_count(const Context& context) {
  return context.threads > 0 ? context.threads : std::max(1, tbb::this_task_arena::max_concurrency());
}

void parallel_chunks(std::size_t count, std::size_t grain, const Context& context,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunks = (count + grain - 1) / grain;
  const auto run = [&](std::size_t chunk) {
    context.check();
    body(chunk * grain, std::min(count, (chunk + 1) * grain));
  };
  const int threads = thread_count(context);
  if (threads == 1 || chunks == 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) run(chunk);
    return;
  }
  arena_of(threads).execute([&] { tbb::parallel_for(std::size_t{0}, chunks, run); });
}

}  // namespace retalho
