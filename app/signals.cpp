#include "signals.h"

#include <csignal>

namespace retalho::app {
namespace {

std::atomic<bool> cancel{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void handle(int) {
  cancel.store(true, std::memory_order_relaxed);
}

}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = handle;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

const std::atomic<bool>& cancel_flag() {
  return cancel;
}

}  // namespace retalho::app
