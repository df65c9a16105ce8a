// `retalho view`: the page, served on this machine.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "input_files.h"

namespace retalho::viewer {

/// Was the program built with the page?
bool has_page();

/// Serves the page until `stop` turns true. `ready` gets the address (with a one-time token in its fragment, guard.h)
/// once the server answers. Throws Error (internal) where no port can be had, and when the program was built without
/// the page.
void serve(const InputFiles& inputs, int threads, const std::atomic<bool>& stop,
           const std::function<void(const std::string& address)>& ready);

}  // namespace retalho::viewer
