// SIGINT, SIGTERM and SIGHUP ask the work to stop (Context::cancel); the outputs in the making are removed on the way
// out. A second signal ends the process at once. SIGPIPE is ignored, so that a closed standard output is an error with
// words.
#pragma once

#include <atomic>
#include <cstdint>

namespace retalho::app {

void catch_signals();
const std::atomic<bool>& cancel_flag();
/// As a signal does. May be called from a signal handler.
void ask_to_stop();
/// outputs_committed() (core/abandon.h) when the flag was set.
std::uint64_t outputs_at_stop();

}  // namespace retalho::app
