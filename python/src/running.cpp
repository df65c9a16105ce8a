#include "running.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "retalho/core/error.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

constexpr std::chrono::milliseconds kLook{50};  // how often the waiting thread looks for signals and progress

/// What the working thread leaves for the waiting one.
struct Shared {
  std::mutex mutex;
  std::condition_variable done_changed;
  bool done = false;
  std::exception_ptr failure;
  std::deque<std::pair<std::string, double>> events;  // one a stage: the newest fraction
  std::atomic<bool> cancel{false};
};

void keep_event(Shared& shared, std::string_view stage, double fraction) {
  const std::lock_guard lock(shared.mutex);
  if (!shared.events.empty() && shared.events.back().first == stage)
    shared.events.back().second = fraction;
  else
    shared.events.emplace_back(stage, fraction);
}

}  // namespace

void run_without_lock(const Running& running, const std::function<void(const Context&)>& work) {
  if (running.threads < 0)
    throw UsageError(fmt::format("threads must be 0 (all cores) or more, not {}", running.threads), {}, "threads");
  const bool reports = !running.progress.is_none();
  if (reports && PyCallable_Check(running.progress.ptr()) == 0)
    throw py::type_error("progress must be a callable (stage: str, fraction: float), or None");
  Shared shared;
  Context context{running.threads, &shared.cancel, {}};
  if (reports) context.progress = [&](std::string_view stage, double fraction) { keep_event(shared, stage, fraction); };
  std::exception_ptr raised;  // by the callable, or a signal
  {
    const py::gil_scoped_release released;
    std::thread worker([&] {
      std::exception_ptr failure;
      try {
        work(context);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(shared.mutex);
      shared.failure = failure;
      shared.done = true;
      shared.done_changed.notify_one();
    });
    for (bool finished = false; !finished;) {
      std::deque<std::pair<std::string, double>> events;
      {
        std::unique_lock lock(shared.mutex);
        finished = shared.done_changed.wait_for(lock, kLook, [&] { return shared.done; });
        events.swap(shared.events);
      }
      if (raised || (finished && events.empty())) continue;
      const py::gil_scoped_acquire held;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        for (const auto& [stage, fraction] : events) running.progress(stage, fraction);
      } catch (const py::error_already_set&) {
        raised = std::current_exception();
        shared.cancel.store(true, std::memory_order_relaxed);
      }
    }
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (shared.failure) std::rethrow_exception(shared.failure);
}

}  // namespace retalho::python
