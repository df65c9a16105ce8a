// A small HTTP/1.1 server for this machine only, safe to have beside a browser that also visits other sites.
//
// Promises: it listens on 127.0.0.1 and on no other address, at a free port that the system chooses; requests are
// handed over whole, never larger than the limits; a client that is slow, silent or gone holds nothing for longer than
// `receive_seconds`; when too many connections wait for their request, the oldest of them is closed. It opens no file.
// It does not decide who may ask what: that is `admit`'s, which sees the headers before any body is read.
//
// libmicrohttpd stands behind this header and nowhere else.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace retalho::viewer {

struct Request {
  std::string method;
  std::string path;                            ///< as sent, undecoded, without the query
  std::map<std::string, std::string> headers;  ///< names in lower case; a name that came twice has both, by ", "
  std::string body;
};

struct Reply {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> body;
  std::vector<std::pair<std::string, std::string>> headers = {};
};

/// One request and what becomes of it. Any thread may answer: either one reply(), or any number of event() and an
/// end(). Calls after the client has gone are allowed and do nothing.
class Exchange {
 public:
  virtual ~Exchange() = default;
  virtual const Request& request() const = 0;
  /// Turns true when the client has closed its side (a closed tab), or the server stops.
  virtual const std::atomic<bool>& gone() const = 0;
  virtual void reply(Reply reply) = 0;
  /// A server-sent event; the first one begins the reply. `data` must hold no line break.
  virtual void event(const std::string& name, const std::string& data) = 0;
  virtual void end() = 0;
};

struct ServerLimits {
  std::size_t body_bytes = std::size_t{1} << 20;
  std::size_t header_bytes = std::size_t{32} << 10;
  int connections = 96;     ///< open at once; beyond, the oldest that has sent no whole request is closed
  int receive_seconds = 8;  ///< from the first byte to the last of a request, and idle between two requests
};

struct ServerHooks {
  /// Headers are known, the body is not: a reply refuses the request. Called on the server's thread.
  std::function<std::optional<Reply>(const Request&)> admit;
  /// The whole request. Called on the server's thread: it must hand the work to another one and return.
  std::function<void(std::shared_ptr<Exchange>)> handle;
  /// Headers of every reply.
  std::vector<std::pair<std::string, std::string>> headers = {};
};

class HttpServer {
 public:
  /// Throws Error (internal) when the system gives no port.
  HttpServer(ServerHooks hooks, const ServerLimits& limits);
  /// Every exchange is gone when this returns.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  int port() const;

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace retalho::viewer
