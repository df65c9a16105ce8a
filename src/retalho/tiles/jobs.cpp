#include "retalho/tiles/jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"

namespace retalho {
namespace {

constexpr std::chrono::milliseconds kTick{100};

struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t next = 0, done = 0, running = 0, failed_at = 0;
  std::exception_ptr failure;
};

}  // namespace

void run_jobs(std::size_t count, int jobs, const std::string& stage, const Context& context,
              const std::function<void(std::size_t, const Context&)>& task) {
  if (jobs < 0) throw UsageError(fmt::format("jobs must be 0 or more, not {}", jobs), {}, "--jobs");
  if (jobs == 0) jobs = thread_count(context);
  if (jobs == 1 || count <= 1) {
    const Context inner{context.threads, context.cancel, {}};
    for (std::size_t k = 0; k < count; ++k) {
      context.check();
      task(k, inner);
      context.report(stage, static_cast<double>(k + 1) / static_cast<double>(count));
    }
    return;
  }
  const Context inner{1, context.cancel, {}};
  Shared shared;
  const auto work = [&] {
    std::unique_lock lock(shared.mutex);
    while (shared.next < count && !shared.failure) {
      const std::size_t k = shared.next++;
      lock.unlock();
      std::exception_ptr failure;
      try {
        inner.check();
        task(k, inner);
      } catch (...) {
        failure = std::current_exception();
      }
      lock.lock();
      ++shared.done;
      if (failure && (!shared.failure || k < shared.failed_at)) {
        shared.failure = failure;
        shared.failed_at = k;
      }
      shared.changed.notify_one();
    }
    --shared.running;
    shared.changed.notify_one();
  };
  std::vector<std::thread> workers;
  shared.running = std::min<std::size_t>(static_cast<std::size_t>(jobs), count);
  for (std::size_t w = shared.running; w > 0; --w) workers.emplace_back(work);
  std::exception_ptr own;  // of the caller's progress
  for (bool finished = false; !finished;) {
    double fraction = 0;
    {
      std::unique_lock lock(shared.mutex);
      shared.changed.wait_for(lock, kTick);
      finished = shared.running == 0;
      fraction = static_cast<double>(shared.done) / static_cast<double>(count);
    }
    if (own) continue;
    try {
      context.report(stage, fraction);
    } catch (...) {
      own = std::current_exception();
      const std::lock_guard lock(shared.mutex);
      shared.next = count;
    }
  }
  for (std::thread& worker : workers) worker.join();
  if (own) std::rethrow_exception(own);
  if (shared.failure) std::rethrow_exception(shared.failure);
}

}  // namespace retalho
