// Long calls: the interpreter lock is released, progress is reported to a callable, Ctrl-C stops the work.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>
#include <type_traits>

#include "retalho/core/context.h"

namespace retalho::python {

/// The two options that every long call has.
struct Running {
  int threads = 0;  ///< 0: all cores
  pybind11::object progress = pybind11::none();
};

/// Runs `work` in a thread of its own without the interpreter lock, while the calling thread waits for signals. What
/// `progress` raises, and KeyboardInterrupt, stop the work and are raised when it has stopped. `work` must not touch
/// Python. Throws UsageError for threads < 0.
void run_without_lock(const Running& running, const std::function<void(const Context&)>& work);

/// The same for work that returns something.
template <class Work>
auto run(const Running& running, Work&& work) {
  using Result = std::invoke_result_t<Work, const Context&>;
  if constexpr (std::is_void_v<Result>) {
    run_without_lock(running, work);
  } else {
    std::optional<Result> result;
    run_without_lock(running, [&](const Context& context) { result.emplace(work(context)); });
    return std::move(*result);
  }
}

}  // namespace retalho::python
