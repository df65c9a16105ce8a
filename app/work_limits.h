// --timeout and --memory-limit: both end the work through the flag that SIGINT sets, so that outputs in the making are
// removed on the way out. Work that does not hear the flag soon (a library's, a long step's) is ended by force, with
// the same message, exit code and clean folder. What the work is known to need is refused before it starts
// (core/memory.h); this is for what cannot be known before.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace retalho::app {

/// "2000000", "512M", "1.5GB", "2GiB" as bytes: units of 1000, with an i of 1024. Throws UsageError.
std::uint64_t parse_memory(const std::string& text);
/// Seconds above 0. Throws UsageError.
double parse_seconds(const std::string& text);

/// Three quarters of what the machine (or its control group) has.
std::uint64_t default_memory_limit();

/// Starts the clock (0: none) and the watch over the resident memory and the flag. `say` tells the user why the work is
/// ended by force, and returns the exit code. For once in a process.
void start_limits(double seconds, std::uint64_t memory, std::function<int()> say);
/// From here on the work ends by itself, however long it takes (a server that closes its connections).
void end_softly();
/// Ends both. For before the process ends.
void stop_limits();

/// Why the work was stopped, if one of the two has stopped it.
struct Stop {
  int code;  ///< 124 as of timeout(1), or 3: the input does not fit
  const char* kind;
  const char* where;
  std::string message;
};
std::optional<Stop> stopped_by_limit();

}  // namespace retalho::app
