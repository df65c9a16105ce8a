// What long work needs from its caller: how many threads, how to report progress, whether to stop. One object, passed
// by const reference as the last argument; the default works and is silent.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string_view>

#include "retalho/core/error.h"

namespace retalho {

struct Context {
  int threads = 0;  ///< Worker threads; 0: all that the machine has. Results never depend on it.
  const std::atomic<bool>* cancel = nullptr;  ///< Set by the caller (a signal handler, a closed tab) to stop the work.
  /// Called from the calling thread with the stage's name and the fraction done in [0, 1].
  std::function<void(std::string_view stage, double fraction)> progress = {};

  /// Throws Interrupted if the caller asked to stop. Cheap: call it once a row or a few thousand steps.
  void check() const {
    if (cancel && cancel->load(std::memory_order_relaxed)) throw Interrupted();
  }
  void report(std::string_view stage, double fraction) const {
    if (progress) progress(stage, fraction);
  }
};

}  // namespace retalho
