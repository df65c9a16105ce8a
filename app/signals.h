// SIGINT, SIGTERM and SIGHUP ask the work to stop (Context::cancel); the outputs in the making are removed on the way
// out. A second signal ends the process at once. SIGPIPE is ignored, so that a closed standard output is an error with
// words.
#pragma once

#include <atomic>

namespace retalho::app {

void catch_signals();
const std::atomic<bool>& cancel_flag();

}  // namespace retalho::app
