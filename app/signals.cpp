#include "signals.h"

#include <unistd.h>

#include <csignal>

#include "retalho/core/abandon.h"

namespace retalho::app {
namespace {

std::atomic<bool> cancel{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

std::atomic<std::uint64_t> committed{0};

void handle(int) {
  if (cancel.load()) return;
  committed.store(outputs_committed());
  cancel.store(true);
}

/// Libraries abort where they cannot go on (GDAL without memory): exit 1 with words, as for all that fails inside.
void aborted(int) {
  constexpr char kWords[] =
      "retalho: failed inside: a library gave up, perhaps for want of memory. Please report it with the command "
      "line.\n";
  if (::write(STDERR_FILENO, kWords, sizeof kWords - 1) < 0) ::_exit(1);
  ::_exit(1);
}

}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = handle;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A closed terminal is like SIGTERM; nohup's wish is kept.
  if (std::signal(SIGHUP, SIG_IGN) != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGABRT, aborted);
}

void ask_to_stop() {
  handle(0);
}

std::uint64_t outputs_at_stop() {
  return committed.load();
}

const std::atomic<bool>& cancel_flag() {
  return cancel;
}

}  // namespace retalho::app
