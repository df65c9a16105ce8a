// Who may ask what: decided from a request's headers, before its body is read.
//
// Another site in the same browser can send requests here, by name (DNS rebinding) or by number: Host stops the first,
// Origin, Sec-Fetch-Site and the session's secret the second. Another user of this machine can connect: the secret
// stops that. The printed address may be seen by others later (in a log, over a shoulder, in a shared terminal): its
// token is good once, and what it was exchanged for is never in an address.
#pragma once

#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "http_server.h"

namespace retalho::viewer {

/// 192 random bits of the system, as 32 letters and digits. Throws Error (internal) when the system gives none.
std::string make_token();

/// Do both have the same bytes? The time taken depends on the lengths alone.
bool same_secret(const std::string& a, const std::string& b);

/// The secrets of one run: tokens, each good for one exchange, and the session's secret, which they are exchanged for.
/// Safe to use from several threads.
class Secrets {
 public:
  static constexpr std::size_t kMostTokens = 8;  ///< that wait for their exchange; the oldest is dropped

  Secrets() : session_(make_token()) {}
  Secrets(std::string session, std::string token) : session_(std::move(session)), tokens_{std::move(token)} {}

  /// A new token, for an address.
  std::string token();
  /// Is it one that has not been exchanged?
  bool has_token(const std::string& token) const;
  /// The session's secret for a token, which is gone then; nothing for any other text.
  std::optional<std::string> exchange(const std::string& token);
  bool is_session(const std::string& secret) const { return same_secret(secret, session_); }

 private:
  const std::string session_;
  mutable std::mutex mutex_;
  std::deque<std::string> tokens_;
};

/// Where a token is exchanged: POST with the header X-Retalho-Token.
inline constexpr const char* kExchangePath = "/api/session";
inline constexpr const char* kTokenHeader = "x-retalho-token";

struct Guard {
  int port = 0;
  const Secrets* secrets = nullptr;
  std::function<bool(const std::string& path)> is_page;  ///< a file of the page: GET, no secret needed, none in it
  std::function<bool(const std::string& path)> is_call;  ///< a call of the API: POST, JSON, with X-Retalho-Session
};

/// The refusal, in words, or nothing.
std::optional<Reply> refuse(const Guard& guard, const Request& request);

/// A reply in words, as {"error": {"kind", "message"}}.
Reply error_reply(int status, const std::string& kind, const std::string& message);

}  // namespace retalho::viewer
