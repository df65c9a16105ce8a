#include "retalho/core/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

std::atomic<std::uint64_t> limit_set{kUnknown};

/// A line of /proc/meminfo, in bytes.
std::uint64_t machine_memory(std::string_view key) {
  std::ifstream file("/proc/meminfo");
  std::string word;
  std::uint64_t kilobytes = 0;
  while (file >> word)
    if (word == key && file >> kilobytes) return kilobytes * 1024;
  return kUnknown;
}

std::optional<std::uint64_t> number_in(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  if (file >> value) return value;
  return std::nullopt;  // missing, or "max"
}

struct Group {
  std::uint64_t limit = kUnknown, left = kUnknown;
};

/// The least limit on the way from the process's own group to the root. Version 1 has a tree for memory alone; a
/// container may show only its own group, as the root.
Group group_memory() {
  Group least;
  const auto take = [&](const std::string& folder, const char* limit_name, const char* used_name) {
    const auto limit = number_in(folder + limit_name), used = number_in(folder + used_name);
    if (!limit || !used) return;
    least.limit = std::min(least.limit, *limit);
    least.left = std::min(least.left, *limit > *used ? *limit - *used : 0);
  };
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // number:controllers:path
    const std::size_t first = line.find(':'), second = first == line.npos ? first : line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool unified = controllers.empty();
    if (!unified && ("," + controllers + ",").find(",memory,") == line.npos) continue;
    std::string path = line.substr(second + 1);
    while (true) {
      if (path == "/") path.clear();
      if (unified)
        take("/sys/fs/cgroup" + path, "/memory.max", "/memory.current");
      else
        take("/sys/fs/cgroup/memory" + path, "/memory.limit_in_bytes", "/memory.usage_in_bytes");
      if (path.empty()) break;
      path.resize(path.rfind('/') == path.npos ? 0 : path.rfind('/'));
    }
  }
  return least;
}

/// Pages of /proc/self/statm: the first number is address space, the second what is resident.
std::uint64_t pages_of(std::size_t which) {
  std::ifstream file("/proc/self/statm");
  std::array<std::uint64_t, 2> pages{};
  file >> pages[0] >> pages[1];
  return file ? pages[which] * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

std::uint64_t address_space() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ? kUnknown : limit.rlim_cur;
}

std::uint64_t address_space_left() {
  const std::uint64_t limit = address_space();
  if (limit == kUnknown) return kUnknown;
  const std::uint64_t used = pages_of(0);
  return limit > used ? limit - used : 0;
}

}  // namespace

std::uint64_t available_memory() {
  return std::min({machine_memory("MemAvailable:"), group_memory().left, address_space_left()});
}

std::uint64_t whole_memory() {
  return std::min({machine_memory("MemTotal:"), group_memory().limit, address_space()});
}

std::uint64_t resident_memory() {
  return pages_of(1);
}

std::string size_text(double bytes) {
  constexpr std::array kUnits{"bytes", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 999.5 && unit + 1 < kUnits.size()) {
    bytes /= 1000;
    ++unit;
  }
  const int digits = bytes >= 99.95 || unit == 0 ? 0 : bytes >= 9.995 ? 1 : 2;
  return fmt::format("{:.{}f} {}", bytes, digits, kUnits[unit]);
}

void set_memory_limit(std::uint64_t bytes) {
  limit_set.store(bytes, std::memory_order_relaxed);
}

std::uint64_t memory_limit() {
  return limit_set.load(std::memory_order_relaxed);
}

void check_memory(double bytes, const std::string& what, const std::string& file) {
  const auto limit = static_cast<double>(memory_limit());
  if (bytes <= limit) return;
  throw BadInput(fmt::format("{} needs about {} of memory, and the limit is {} (--memory-limit): raise it on a machine "
                             "that has more, or take a part of the input or a coarser result",
                             what, size_text(bytes), size_text(limit)),
                 file, "--memory-limit");
}

}  // namespace retalho
