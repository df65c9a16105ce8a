#include "work.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <new>
#include <thread>

#include "guard.h"
#include "retalho/core/error.h"

namespace retalho::viewer {
namespace {

constexpr std::size_t kMostWaiting = 64;
constexpr std::size_t kMostKept = 16;  // answers that no one has fetched
constexpr std::size_t kMostKeptBytes = std::size_t{256} << 20;
constexpr const char* kFetch = "/api/result";

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json parse_body(const std::string& body) {
  Json json = Json::parse(body.empty() ? "{}" : body, nullptr, false);
  if (json.is_discarded() || !json.is_object()) throw BadInput("the body is not a JSON object");
  return json;
}

/// What went wrong, as the program says it. Must be called in a catch block.
Json error_words() {
  const auto words = [](const std::string& kind, const std::string& message) {
    return Json{{"error", {{"kind", kind}, {"message", message}}}};
  };
  try {
    throw;
  } catch (const Error& error) {
    return words(kind_name(error.kind()), error.what());
  } catch (const std::bad_alloc&) {
    return words("internal", "out of memory: try a larger tolerance or a smaller grid");
  } catch (const std::exception& error) {
    return words("internal", fmt::format("failed inside: {}", error.what()));
  }
}

Reply json_reply(const Json& json, int status = 200) {
  Reply reply;
  reply.status = status;
  reply.type = "application/json";
  reply.body = std::make_shared<const std::string>(dump(json));
  return reply;
}

Reply packed_reply(std::shared_ptr<const std::string> bytes) {
  Reply reply;
  reply.type = "application/octet-stream";
  reply.body = std::move(bytes);
  return reply;
}

/// The arrays of slow calls, until the page has fetched them (once).
class Kept {
 public:
  std::uint64_t put(std::string bytes) {
    const std::lock_guard lock(mutex_);
    total_ += bytes.size();
    kept_[++last_] = std::make_shared<const std::string>(std::move(bytes));
    while (kept_.size() > kMostKept || (total_ > kMostKeptBytes && kept_.size() > 1)) {
      total_ -= kept_.begin()->second->size();
      kept_.erase(kept_.begin());
    }
    return last_;
  }
  std::shared_ptr<const std::string> take(std::uint64_t id) {
    const std::lock_guard lock(mutex_);
    const auto at = kept_.find(id);
    if (at == kept_.end()) throw BadInput("this answer was fetched already, or has been dropped: ask again");
    auto bytes = at->second;
    total_ -= bytes->size();
    kept_.erase(at);
    return bytes;
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<const std::string>> kept_;
  std::uint64_t last_ = 0;
  std::size_t total_ = 0;
};

}  // namespace

struct Workers::Parts {
  using Item = std::shared_ptr<Exchange>;

  struct Lane {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Item> waiting;
    bool stopped = false;
    std::thread thread;
  };

  Parts(CallTable calls, int call_threads) : table(std::move(calls)), threads(call_threads) {
    quick.thread = std::thread([this] { run(quick); });
    slow.thread = std::thread([this] { run(slow); });
  }

  Lane& lane_of(const std::string& path) {
    const auto at = table.find(path);
    return at != table.end() && at->second.kind == Call::Kind::slow ? slow : quick;
  }

  void run(Lane& lane) {
    for (;;) {
      Item item;
      {
        std::unique_lock lock(lane.mutex);
        lane.changed.wait(lock, [&] { return lane.stopped || !lane.waiting.empty(); });
        if (lane.stopped) return;
        item = lane.waiting.front();
        lane.waiting.pop_front();
      }
      if (item->gone()) {
        item->end();
        continue;
      }
      const std::string& path = item->request().path;
      if (path == kFetch)
        fetch(*item);
      else if (const Call& call = table.at(path); call.kind == Call::Kind::slow)
        answer_slowly(*item, call);
      else
        answer(*item, call);
    }
  }

  void fetch(Exchange& exchange) {
    try {
      const Json input = parse_body(exchange.request().body);
      exchange.reply(packed_reply(kept.take(static_cast<std::uint64_t>(whole(input, "id", 1, 1LL << 50)))));
    } catch (...) {
      exchange.reply(json_reply(error_words(), 400));
    }
  }

  Context context_of(Exchange& exchange) const {
    Context context;
    context.threads = threads;
    context.cancel = &exchange.gone();
    return context;
  }

  void answer(Exchange& exchange, const Call& call) {
    try {
      const Answer a = call.run(parse_body(exchange.request().body), context_of(exchange));
      if (a.arrays.empty())
        exchange.reply(json_reply(a.words));
      else
        exchange.reply(packed_reply(std::make_shared<const std::string>(pack(a))));
    } catch (...) {
      exchange.reply(json_reply(error_words(), 400));
    }
  }

  void answer_slowly(Exchange& exchange, const Call& call) {
    try {
      const Json input = parse_body(exchange.request().body);
      Context context = context_of(exchange);
      auto last = std::chrono::steady_clock::time_point{};
      std::string stage_before;
      context.progress = [&](std::string_view stage, double fraction) {
        const auto now = std::chrono::steady_clock::now();
        if (stage == stage_before && now - last < std::chrono::milliseconds(100)) return;
        last = now;
        stage_before = stage;
        exchange.event("progress", dump({{"stage", std::string(stage)}, {"fraction", fraction}}));
      };
      Answer a = call.run(input, context);
      if (exchange.gone()) throw Interrupted();
      Json words = {{"words", a.words}};
      if (!a.arrays.empty()) words["result"] = kept.put(pack(a));
      exchange.event("done", dump(words));
    } catch (...) {
      exchange.event("failed", dump(error_words()));
    }
    exchange.end();
  }

  CallTable table;
  int threads;
  Kept kept;
  Lane quick, slow;
};

Workers::Workers(CallTable table, int threads) : parts_(std::make_unique<Parts>(std::move(table), threads)) {}

Workers::~Workers() {
  stop();
}

void Workers::stop() {
  for (Parts::Lane* lane : {&parts_->quick, &parts_->slow}) {
    {
      const std::lock_guard lock(lane->mutex);
      lane->stopped = true;
      lane->waiting.clear();
    }
    lane->changed.notify_all();
    if (lane->thread.joinable()) lane->thread.join();
  }
}

bool Workers::knows(const std::string& path) const {
  return path == kFetch || parts_->table.contains(path);
}

void Workers::submit(std::shared_ptr<Exchange> exchange) {
  Parts::Lane& lane = parts_->lane_of(exchange->request().path);
  {
    const std::lock_guard lock(lane.mutex);
    if (lane.waiting.size() < kMostWaiting && !lane.stopped) {
      lane.waiting.push_back(exchange);
      exchange = nullptr;
    }
  }
  if (exchange) exchange->reply(error_reply(503, "busy", "too many calls wait for their turn: try again"));
  lane.changed.notify_one();
}

}  // namespace retalho::viewer
