#include "http_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstring>
#include <mutex>
#include <thread>

#include "retalho/core/error.h"

namespace retalho::viewer {
namespace {

using Clock = std::chrono::steady_clock;

/// An exchange on its connection. `mutex` orders the threads that answer against the server's thread.
class Live : public Exchange {
 public:
  explicit Live(MHD_Connection* connection) : connection_(connection) {}

  const Request& request() const override { return request_; }
  const std::atomic<bool>& gone() const override { return gone_; }

  void reply(Reply reply) override {
    const std::lock_guard lock(mutex_);
    if (answered_) return;
    answered_ = true;
    reply_ = std::move(reply);
    wake();
  }

  void event(const std::string& name, const std::string& data) override {
    const std::lock_guard lock(mutex_);
    if (ended_ || (answered_ && !streaming_) || gone_) return;
    answered_ = streaming_ = true;
    pending_ += "event: " + name + "\ndata: " + data + "\n\n";
    wake();
  }

  void end() override {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    wake();
  }

  /// On the server's thread: waits for an answer by putting the connection to sleep.
  bool answered_or_sleep() {
    const std::lock_guard lock(mutex_);
    if (answered_ || gone_) return true;
    sleep();
    return false;
  }

  /// MHD's content reader: what there is, or sleep.
  ssize_t read(char* out, std::size_t size) {
    const std::lock_guard lock(mutex_);
    if (pending_.empty()) {
      if (ended_ || gone_) return MHD_CONTENT_READER_END_OF_STREAM;
      sleep();
      return 0;
    }
    const std::size_t n = std::min(size, pending_.size());
    std::memcpy(out, pending_.data(), n);
    pending_.erase(0, n);
    return static_cast<ssize_t>(n);
  }

  void leave() {
    const std::lock_guard lock(mutex_);
    gone_ = true;
    wake();
  }

  /// The connection is over: it may not be touched any more.
  void forget() {
    const std::lock_guard lock(mutex_);
    gone_ = true;
    connection_ = nullptr;
    asleep_ = false;
  }

  bool streaming() {
    const std::lock_guard lock(mutex_);
    return streaming_;
  }
  MHD_Connection* connection() {
    const std::lock_guard lock(mutex_);
    return connection_;
  }

  Request request_;
  Reply reply_;
  bool dispatched_ = false;

 private:
  void sleep() {
    asleep_ = true;
    MHD_suspend_connection(connection_);
  }
  void wake() {
    if (!asleep_ || !connection_) return;
    asleep_ = false;
    MHD_resume_connection(connection_);
  }

  std::mutex mutex_;
  MHD_Connection* connection_;
  std::string pending_;
  bool answered_ = false, streaming_ = false, ended_ = false, asleep_ = false;
  std::atomic<bool> gone_{false};
};

using LivePointer = std::shared_ptr<Live>;

Reply plain(int status, const std::string& words) {
  Reply reply;
  reply.status = status;
  reply.body = std::make_shared<const std::string>(words + "\n");
  return reply;
}

MHD_Result keep_header(void* headers, MHD_ValueKind, const char* key, const char* value) {
  std::string name(key);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  std::string& kept = (*static_cast<std::map<std::string, std::string>*>(headers))[name];
  if (!kept.empty()) kept += ", ";
  kept += value ? value : "";
  return MHD_YES;
}

std::size_t leave_escaped(void*, MHD_Connection*, char* text) {
  return std::strlen(text);
}

}  // namespace

class HttpServer::Parts {
 public:
  Parts(ServerHooks hooks, const ServerLimits& limits) : hooks_(std::move(hooks)), limits_(limits) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = 0;
    daemon_ =
        MHD_start_daemon(MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr, &Parts::access,
                         this, MHD_OPTION_SOCK_ADDR, reinterpret_cast<sockaddr*>(&address), MHD_OPTION_CONNECTION_LIMIT,
                         static_cast<unsigned>(4 * limits_.connections), MHD_OPTION_CONNECTION_TIMEOUT,
                         static_cast<unsigned>(limits_.receive_seconds), MHD_OPTION_CONNECTION_MEMORY_LIMIT,
                         limits_.header_bytes, MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_UNESCAPE_CALLBACK,
                         &leave_escaped, nullptr, MHD_OPTION_NOTIFY_COMPLETED, &Parts::completed, this,
                         MHD_OPTION_NOTIFY_CONNECTION, &Parts::connection_changed, this, MHD_OPTION_END);
    const MHD_DaemonInfo* info = daemon_ ? MHD_get_daemon_info(daemon_, MHD_DAEMON_INFO_BIND_PORT) : nullptr;
    if (!info || info->port == 0) {
      if (daemon_) MHD_stop_daemon(daemon_);
      throw Error(Error::Kind::internal, "cannot listen on 127.0.0.1: the system gives no port to this program");
    }
    port_ = info->port;
    watch_ = std::thread([this] { watch(); });
  }

  ~Parts() {
    stopping_ = true;
    watch_.join();
    MHD_quiesce_daemon(daemon_);  // its socket is closed with the process
    for (;;) {                    // sleeping connections may not be stopped: all are woken, until none is left
      const std::vector<LivePointer> all = everyone();
      if (all.empty()) break;
      for (const LivePointer& one : all) one->leave();
      shut_all();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    MHD_stop_daemon(daemon_);
  }

  int port() const { return port_; }

 private:
  struct Socket {
    int fd;
    Clock::time_point since;  // connected, or done with its last request
    bool receiving;
  };

  static MHD_Result access(void* self, MHD_Connection* connection, const char* url, const char* method, const char*,
                           const char* data, std::size_t* size, void** slot) {
    return static_cast<Parts*>(self)->on_access(connection, url, method, data, size, slot);
  }
  static void completed(void* self, MHD_Connection* connection, void** slot, MHD_RequestTerminationCode) {
    auto* live = static_cast<LivePointer*>(*slot);
    if (live) (*live)->forget();
    static_cast<Parts*>(self)->drop(connection, live ? live->get() : nullptr);
    delete live;
    *slot = nullptr;
  }
  static void connection_changed(void* self, MHD_Connection* connection, void**, MHD_ConnectionNotificationCode code) {
    static_cast<Parts*>(self)->on_connection(connection, code == MHD_CONNECTION_NOTIFY_STARTED);
  }

  MHD_Result on_access(MHD_Connection* connection, const char* url, const char* method, const char* data,
                       std::size_t* size, void** slot) {
    if (!*slot) {
      auto live = std::make_shared<Live>(connection);
      live->request_.method = method;
      live->request_.path = url;
      MHD_get_connection_values(connection, MHD_HEADER_KIND, &keep_header, &live->request_.headers);
      *slot = new LivePointer(live);
      {
        const std::lock_guard lock(mutex_);
        live_.push_back(live);
      }
      std::optional<Reply> refusal = hooks_.admit(live->request_);
      const auto length = live->request_.headers.find("content-length");
      if (!refusal && length != live->request_.headers.end() &&
          (length->second.size() > 9 || std::stoul("0" + length->second) > limits_.body_bytes))
        refusal = plain(413, fmt::format("the body is larger than {} bytes", limits_.body_bytes));
      if (!refusal) return MHD_YES;
      set_receiving(connection, false);
      live->dispatched_ = true;
      live->reply(std::move(*refusal));
      return send(connection, live);
    }
    const LivePointer live = *static_cast<LivePointer*>(*slot);
    if (*size > 0) {
      if (live->request_.body.size() + *size > limits_.body_bytes) return MHD_NO;  // closes the connection
      live->request_.body.append(data, *size);
      *size = 0;
      return MHD_YES;
    }
    if (!live->dispatched_) {
      live->dispatched_ = true;
      set_receiving(connection, false);
      hooks_.handle(live);
    }
    if (!live->answered_or_sleep()) return MHD_YES;
    return send(connection, live);
  }

  MHD_Result send(MHD_Connection* connection, const LivePointer& pointer) {
    Live& live = *pointer;
    MHD_Response* response = nullptr;
    int status = MHD_HTTP_OK;
    if (live.streaming()) {
      response = MHD_create_response_from_callback(
          MHD_SIZE_UNKNOWN, 8192,
          [](void* cls, std::uint64_t, char* out, std::size_t max) {
            return (*static_cast<LivePointer*>(cls))->read(out, max);
          },
          new LivePointer(pointer), [](void* cls) { delete static_cast<LivePointer*>(cls); });
      MHD_add_response_header(response, "Content-Type", "text/event-stream");
    } else {
      Reply& reply = live.reply_;
      if (!reply.body) return MHD_NO;  // gone before there was an answer
      status = reply.status;
      // The response keeps the bytes alive until MHD has sent them, although the exchange may be over before.
      auto* kept = new std::shared_ptr<const std::string>(reply.body);
      response = MHD_create_response_from_callback(
          (*kept)->size(), 65536,
          [](void* cls, std::uint64_t at, char* out, std::size_t max) -> ssize_t {
            const std::string& bytes = **static_cast<std::shared_ptr<const std::string>*>(cls);
            if (at >= bytes.size()) return MHD_CONTENT_READER_END_OF_STREAM;
            const std::size_t n = std::min(max, bytes.size() - static_cast<std::size_t>(at));
            std::copy_n(bytes.data() + at, n, out);
            return static_cast<ssize_t>(n);
          },
          kept, [](void* cls) { delete static_cast<std::shared_ptr<const std::string>*>(cls); });
      MHD_add_response_header(response, "Content-Type", reply.type.c_str());
      for (const auto& [name, value] : reply.headers) MHD_add_response_header(response, name.c_str(), value.c_str());
    }
    for (const auto& [name, value] : hooks_.headers) MHD_add_response_header(response, name.c_str(), value.c_str());
    const MHD_Result queued = MHD_queue_response(connection, static_cast<unsigned>(status), response);
    MHD_destroy_response(response);
    return queued;
  }

  void on_connection(MHD_Connection* connection, bool started) {
    const std::lock_guard lock(mutex_);
    if (!started) {
      sockets_.erase(connection);
      return;
    }
    const MHD_ConnectionInfo* info = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    if (!info) return;
    sockets_[connection] = {info->connect_fd, Clock::now(), true};
    if (static_cast<int>(sockets_.size()) <= limits_.connections) return;
    const Socket* oldest = nullptr;
    for (const auto& [other, socket] : sockets_)
      if (socket.receiving && (!oldest || socket.since < oldest->since)) oldest = &socket;
    if (oldest) shutdown(oldest->fd, SHUT_RDWR);
  }

  void set_receiving(MHD_Connection* connection, bool receiving) {
    const std::lock_guard lock(mutex_);
    const auto at = sockets_.find(connection);
    if (at == sockets_.end()) return;
    at->second.receiving = receiving;
    at->second.since = Clock::now();
  }

  void drop(MHD_Connection* connection, const Live* live) {
    set_receiving(connection, true);
    const std::lock_guard lock(mutex_);
    std::erase_if(live_, [live](const LivePointer& one) { return one.get() == live; });
  }

  std::vector<LivePointer> everyone() {
    const std::lock_guard lock(mutex_);
    return live_;
  }

  void shut_all() {
    const std::lock_guard lock(mutex_);
    for (const auto& [connection, socket] : sockets_) shutdown(socket.fd, SHUT_RDWR);
  }

  /// Closes what is slow, and tells exchanges whose client has hung up. A sleeping connection is not looked at by MHD.
  void watch() {
    while (!stopping_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      bool someone_left = false;
      {
        const std::lock_guard lock(mutex_);
        const Clock::time_point limit = Clock::now() - std::chrono::seconds(limits_.receive_seconds);
        for (auto& [connection, socket] : sockets_) {
          if (socket.receiving) {
            if (socket.since < limit) shutdown(socket.fd, SHUT_RDWR);
            continue;
          }
          pollfd query{socket.fd, POLLRDHUP, 0};
          if (poll(&query, 1, 0) > 0 && (query.revents & (POLLRDHUP | POLLHUP | POLLERR))) {
            left_.push_back(connection);
            someone_left = true;
          }
        }
      }
      if (!someone_left) continue;
      for (const LivePointer& one : everyone())
        if (std::find(left_.begin(), left_.end(), one->connection()) != left_.end()) one->leave();
      left_.clear();
    }
  }

  ServerHooks hooks_;
  ServerLimits limits_;
  MHD_Daemon* daemon_ = nullptr;
  int port_ = 0;
  std::mutex mutex_;  // live_, sockets_; never held while an exchange's own mutex is taken
  std::vector<LivePointer> live_;
  std::map<MHD_Connection*, Socket> sockets_;
  std::vector<MHD_Connection*> left_;  // the watching thread's
  std::atomic<bool> stopping_{false};
  std::thread watch_;
};

HttpServer::HttpServer(ServerHooks hooks, const ServerLimits& limits)
    : parts_(std::make_unique<Parts>(std::move(hooks), limits)) {}
HttpServer::~HttpServer() = default;
int HttpServer::port() const {
  return parts_->port();
}

}  // namespace retalho::viewer
