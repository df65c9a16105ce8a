// Runs calls off the server's thread: one thread for quick ones, one for slow ones, so that a click is answered while a
// fit is running. A client that has gone cancels what it asked for, also while it waits for its turn.
#pragma once

#include <memory>

#include "calls.h"
#include "http_server.h"

namespace retalho::viewer {

class Workers {
 public:
  /// `threads` is what each call may use (Context::threads).
  Workers(CallTable table, int threads);
  ~Workers();  ///< waits for the calls in work; their exchanges must be gone or will be served
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  bool knows(const std::string& path) const;
  /// Queues the exchange, whose path must be known. Refuses with words when too many wait.
  void submit(std::shared_ptr<Exchange> exchange);
  /// Ends the waiting calls and cancels those in work.
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace retalho::viewer
