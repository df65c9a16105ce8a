#include "work_limits.h"

#include <fmt/format.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include "retalho/core/abandon.h"
#include "retalho/core/error.h"
#include "retalho/core/memory.h"
#include "signals.h"

namespace retalho::app {
namespace {

constexpr double kShare = 0.75;
constexpr int kTimedOut = 124;
constexpr auto kLook = std::chrono::milliseconds(10);  // a look costs 10 us
constexpr double kBrim = 0.95;                         // of the limit: what is taken until the work hears of it
constexpr int kPatience = 5;                           // looks after the flag was set, until force
constexpr double kLongest = 1e8;                       // seconds: three years; what the timer takes

std::atomic<bool> late{false}, heavy{false};
double seconds_given = 0;

void ring(int) {
  late.store(true, std::memory_order_relaxed);
  ask_to_stop();
}

std::atomic<bool> soft{false};

/// Looks at the resident memory, not at single allocations: libraries allocate too, and address space is no memory.
class Watch {
 public:
  ~Watch() { stop(); }
  void start(std::function<int()> say) {
    say_ = std::move(say);
    thread_ = std::thread([this] {
      std::unique_lock lock(mutex_);
      while (!wake_.wait_for(lock, kLook, [this] { return ended_; })) look();
    });
  }
  void stop() {
    if (!thread_.joinable()) return;
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }

 private:
  void look() {
    if (!cancel_flag().load(std::memory_order_relaxed)) {
      if (static_cast<double>(resident_memory()) <= kBrim * static_cast<double>(memory_limit())) return;
      heavy.store(true, std::memory_order_relaxed);
      ask_to_stop();
      return;
    }
    if (soft.load(std::memory_order_relaxed) || ++looks_since_ < kPatience) return;
    // An output that was completed since then: the program is about to end well, and says so itself.
    if (outputs_committed() != outputs_at_stop() || !abandon_outputs()) return;
    ::_exit(say_());
  }

  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::function<int()> say_;
  int looks_since_ = 0;
  bool ended_ = false;
};

Watch& watch() {
  static Watch one;
  return one;
}

}  // namespace

std::uint64_t parse_memory(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  std::string unit = end;
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::toupper(c); });
  double factor = 1;
  if (!unit.empty() && unit.front() != 'B') {
    const std::size_t power = std::string_view("KMGT").find(unit.front());
    const std::string rest = unit.substr(1);
    const bool known = power != std::string_view::npos && (rest.empty() || rest == "B" || rest == "IB");
    factor = known ? std::pow(rest == "IB" ? 1024.0 : 1000.0, static_cast<double>(power + 1)) : 0;
  } else if (unit.size() > 1) {
    factor = 0;
  }
  const double bytes = value * factor;
  if (end == text.c_str() || !std::isfinite(bytes) || bytes < 1 || bytes > 9e18)
    throw UsageError(
        fmt::format("--memory-limit: '{}' is no size: a number of bytes, or such as 512M, 1.5GB, 2GiB", text), {},
        "--memory-limit");
  return static_cast<std::uint64_t>(bytes);
}

double parse_seconds(const std::string& text) {
  char* end = nullptr;
  const double seconds = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0' || !(seconds > 0) || !std::isfinite(seconds))
    throw UsageError(fmt::format("--timeout: '{}' is no number of seconds above 0", text), {}, "--timeout");
  return std::clamp(seconds, 1e-6, kLongest);
}

std::uint64_t default_memory_limit() {
  return static_cast<std::uint64_t>(kShare * static_cast<double>(whole_memory()));
}

void start_limits(double seconds, std::uint64_t memory, std::function<int()> say) {
  seconds_given = seconds;
  set_memory_limit(memory);
  watch().start(std::move(say));
  if (seconds <= 0) return;
  struct sigaction action {};
  action.sa_handler = ring;
  sigemptyset(&action.sa_mask);  // no SA_RESTART: an input that never comes (a pipe) is waited for no longer
  sigaction(SIGALRM, &action, nullptr);
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(seconds);
  timer.it_value.tv_usec = static_cast<suseconds_t>((seconds - std::floor(seconds)) * 1e6);
  if (timer.it_value.tv_sec == 0 && timer.it_value.tv_usec == 0) timer.it_value.tv_usec = 1;
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void end_softly() {
  soft.store(true, std::memory_order_relaxed);
}

void stop_limits() {
  const itimerval none{};
  if (seconds_given > 0) setitimer(ITIMER_REAL, &none, nullptr);
  watch().stop();
}

std::optional<Stop> stopped_by_limit() {
  if (heavy.load(std::memory_order_relaxed))
    return Stop{static_cast<int>(Error::Kind::bad_input), kind_name(Error::Kind::bad_input), "--memory-limit",
                fmt::format("the work took more memory than the limit of {} (--memory-limit) and was stopped, and no "
                            "output is left: raise it on a machine that has more, or take a part of the input or a "
                            "coarser result",
                            size_text(static_cast<double>(memory_limit())))};
  if (late.load(std::memory_order_relaxed))
    return Stop{kTimedOut, "timed_out", "--timeout",
                fmt::format("the work was stopped after the {:g} s of --timeout, and no output is left: give it more "
                            "time, or less to do",
                            seconds_given)};
  return std::nullopt;
}

}  // namespace retalho::app
