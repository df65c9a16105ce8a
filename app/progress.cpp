#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

namespace retalho::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kBarWidth = 30;

struct State {
  bool bar = false, verbose = false, drawn = false;
  Clock::time_point start, stage_start, last_draw;
  std::string stage;
};

State& state() {
  static State s;
  return s;
}

double since(Clock::time_point t) {
  return std::chrono::duration<double>(Clock::now() - t).count();
}

std::string duration_words(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

void draw(State& s, double fraction) {
  const double f = std::clamp(std::isfinite(fraction) ? fraction : 0.0, 0.0, 1.0);
  const int filled = static_cast<int>(f * kBarWidth);
  std::string line = fmt::format("\r{} [{}{}] {:3.0f} %", s.stage, std::string(static_cast<std::size_t>(filled), '#'),
                                 std::string(static_cast<std::size_t>(kBarWidth - filled), '.'), 100 * f);
  if (f > 0.02) line += fmt::format(", {} left", duration_words(since(s.stage_start) / f * (1 - f)));
  line += "\x1b[K";
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
  s.drawn = true;
}

void end_stage(State& s) {
  if (s.verbose && !s.stage.empty()) fmt::print(stderr, "{}: {:.3f} s\n", s.stage, since(s.stage_start));
  s.stage.clear();
}

}  // namespace

void start_progress(bool bar, bool verbose) {
  State& s = state();
  s = State{};
  s.bar = bar && ::isatty(STDERR_FILENO) != 0;
  s.verbose = verbose;
  s.start = s.stage_start = s.last_draw = Clock::now();
}

void show_progress(std::string_view stage, double fraction) {
  State& s = state();
  if (s.stage != stage) {
    clear_progress();
    end_stage(s);
    s.stage = stage;
    s.stage_start = Clock::now();
  }
  if (!s.bar || since(s.start) < 1.0 || since(s.last_draw) < 0.1) return;
  s.last_draw = Clock::now();
  draw(s, fraction);
}

void clear_progress() {
  State& s = state();
  if (!s.drawn) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  s.drawn = false;
}

void end_progress() {
  clear_progress();
  end_stage(state());
}

}  // namespace retalho::app
