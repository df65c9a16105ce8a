#include "retalho/core/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace retalho {

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
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, chunks, run); });
}

}  // namespace retalho
