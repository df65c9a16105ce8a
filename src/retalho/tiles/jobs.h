// Many tasks of their own, several at a time, each on one thread. Internal to the room.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "retalho/core/context.h"

namespace retalho {

/// Runs task(k, context) for k in [0, count), `jobs` at a time (0: as many as there are threads; 1: each with all
/// threads). Progress is reported from the calling thread. The first error, by k among those that happened, is thrown
/// when the tasks that run have ended; no new ones are begun.
void run_jobs(std::size_t count, int jobs, const std::string& stage, const Context& context,
              const std::function<void(std::size_t k, const Context&)>& task);

}  // namespace retalho
