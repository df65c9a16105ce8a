// Who may ask what: decided from a request's headers, before its body is read.
//
// Another site in the same browser can send requests here, by name (DNS rebinding) or by number: Host stops the first,
// Origin, Sec-Fetch-Site and the token the second. Another user of this machine can connect: the token stops that.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "http_server.h"

namespace retalho::viewer {

/// 192 random bits of the system, as 32 letters and digits.
std::string make_token();

/// Do both have the same bytes? The time taken depends on the lengths alone.
bool same_secret(const std::string& a, const std::string& b);

struct Guard {
  int port = 0;
  std::string token;
  std::function<bool(const std::string& path)> is_page;  ///< a file of the page: GET, no token, no secret in it
  std::function<bool(const std::string& path)> is_call;  ///< a call of the API: POST, JSON, with the token
};

/// The refusal, in words, or nothing.
std::optional<Reply> refuse(const Guard& guard, const Request& request);

/// A reply in words, as {"error": {"kind", "message"}}.
Reply error_reply(int status, const std::string& kind, const std::string& message);

}  // namespace retalho::viewer
