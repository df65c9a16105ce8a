#include "retalho/core/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "retalho/core/abandon.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;

std::atomic<std::uint64_t> committed_count{0};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "a signal handler reads it");

/// The temporaries of all outputs in the making. Never destroyed: threads may end after main.
struct InTheMaking {
  std::mutex list, naming;  ///< of the set; held while an output takes its name
  std::multiset<std::string> temporaries;
};
InTheMaking& in_the_making() {
  static auto* const all = new InTheMaking;
  return *all;
}

std::string reason() {
  return std::strerror(errno);
}

/// open(), again where a signal came in between.
int open_file(const std::string& path, int flags) {
  for (;;) {
    const int fd = ::open(path.c_str(), flags, 0666);
    if (fd >= 0 || errno != EINTR) return fd;
  }
}

/// Flushes a file or a folder to disk. Returns false with errno set.
bool sync_path(const std::string& path, int flags) {
  const int fd = open_file(path, flags | O_CLOEXEC);
  if (fd < 0) return false;
  bool done = ::fsync(fd) == 0;
  while (!done && errno == EINTR) done = ::fsync(fd) == 0;
  const int saved = errno;
  ::close(fd);
  errno = saved;
  return done;
}

std::string folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

/// What follows the stem in the names of the files beside `file` that share it, `file` itself left out. Sorted, so
/// that the same parts are renamed in the same order on every file system.
std::vector<std::string> parts_beside(const std::string& file) {
  std::vector<std::string> tails;
  const std::string own = fs::path(file).filename().string();
  const std::string stem = fs::path(file).stem().string();
  std::error_code ec;
  fs::directory_iterator entry(folder_of(file), ec);
  for (; !ec && entry != fs::directory_iterator(); entry.increment(ec)) {
    const std::string name = entry->path().filename().string();
    if (name != own && name.starts_with(stem + ".")) tails.push_back(name.substr(stem.size()));
  }
  std::sort(tails.begin(), tails.end());
  return tails;
}

std::string with_tail(const std::string& file, const std::string& tail) {
  return (fs::path(folder_of(file)) / (fs::path(file).stem().string() + tail)).string();
}

/// Gives `from` the name `to`. Throws CannotWrite, naming `to`.
void take_name(const std::string& from, const std::string& to, bool overwrite) {
  // link() refuses an existing name, so that two runs without --overwrite cannot replace each other's result.
  if (!overwrite && ::link(from.c_str(), to.c_str()) == 0) {
    ::unlink(from.c_str());
    return;
  }
  if (!overwrite && errno == EEXIST)
    throw CannotWrite(fmt::format("'{}' exists: add --overwrite to replace it", to), to);
  if (::rename(from.c_str(), to.c_str()) != 0)
    throw CannotWrite(fmt::format("cannot rename to '{}': {}", to, reason()), to);
}

/// This machine and its process numbers, in eight digits: a name made elsewhere says nothing about a process of ours.
const std::string& this_machine() {
  static const std::string mark = [] {
    char host[256] = {}, processes[64] = {};
    if (::gethostname(host, sizeof host - 1) != 0) host[0] = '\0';
    if (::readlink("/proc/self/ns/pid", processes, sizeof processes - 1) < 0) processes[0] = '\0';
    std::uint32_t hash = 2166136261;  // FNV-1a: the same in every run
    for (const char* part : {host, processes})
      for (; *part != '\0'; ++part) hash = (hash ^ static_cast<unsigned char>(*part)) * 16777619U;
    return fmt::format("{:08x}", hash);
  }();
  return mark;
}

/// ".name.machine-process": with ".tmp" and the ending a file in the making, with ".old" an old one that is away.
std::string hidden_stem(const fs::path& path) {
  return fmt::format(".{}.{}-{}", path.filename().string(), this_machine(), ::getpid());
}

/// The hidden names beside `path` that belong to it and whose makers are gone; `kind` is ".tmp" or ".old".
std::vector<std::string> stale(const fs::path& path, const std::string& kind) {
  std::vector<std::string> names;
  const std::string folder = folder_of(path.string()), start = fmt::format(".{}.", path.filename().string());
  std::error_code ec;
  fs::directory_iterator entry(folder, ec);
  for (; !ec && entry != fs::directory_iterator(); entry.increment(ec)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(start)) continue;
    unsigned machine = 0;
    int process = 0, length = 0;
    const char* const rest = name.c_str() + start.size();
    if (std::sscanf(rest, "%8x-%d%n", &machine, &process, &length) != 2 || process <= 0) continue;
    if (!std::string_view(rest + length).starts_with(kind)) continue;
    struct stat info {};
    if (::stat(entry->path().c_str(), &info) != 0) continue;
    const bool ours = std::string_view(rest).starts_with(this_machine());
    constexpr double kDay = 86400;
    const bool gone =
        ours ? ::kill(process, 0) != 0 && errno == ESRCH : std::difftime(std::time(nullptr), info.st_mtime) > kDay;
    if (gone) names.push_back(entry->path().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// What a killed process left beside `path`. An old set that was away comes back when no file took its name; one beside
/// a file that is there was replaced, and goes.
void sweep(const fs::path& path) {
  for (const std::string& name : stale(path, ".tmp")) ::unlink(name.c_str());
  const std::vector<std::string> away = stale(path, ".old");
  if (away.empty()) return;
  std::error_code ec;
  const bool replaced = fs::exists(path, ec);
  const auto back = [&](const std::string& name) {
    const std::string tail = name.substr(name.rfind(".old") + 4);
    const std::string to = with_tail(path.string(), tail);
    if (replaced || ::rename(name.c_str(), to.c_str()) != 0) ::unlink(name.c_str());
  };
  const auto is_main = [&](const std::string& name) { return name.ends_with(".old" + path.extension().string()); };
  for (const std::string& name : away)
    if (!is_main(name)) back(name);
  for (const std::string& name : away)
    if (is_main(name)) back(name);
}

void remove_with_parts(const std::string& temporary) {
  for (const std::string& tail : parts_beside(temporary)) ::unlink(with_tail(temporary, tail).c_str());
  ::unlink(temporary.c_str());
}

}  // namespace

std::uint64_t outputs_committed() {
  return committed_count.load();
}

bool abandon_outputs() {
  InTheMaking& making = in_the_making();
  if (!making.naming.try_lock()) return false;
  const std::lock_guard lock(making.list);
  for (const std::string& temporary : making.temporaries) remove_with_parts(temporary);
  return true;
}

AtomicFile::AtomicFile(std::string path, bool overwrite) : path_(std::move(path)), overwrite_(overwrite) {
  const fs::path final_path(path_);
  fs::path folder = final_path.parent_path();
  if (folder.empty()) folder = ".";
  std::error_code ec;
  if (path_.empty() || final_path.filename().empty())
    throw CannotWrite(fmt::format("'{}' is not a file name: give the output's name", path_), path_);
  if (!fs::is_directory(folder, ec))
    throw CannotWrite(fmt::format("the folder '{}' does not exist: make it first", folder.string()), path_);
  if (fs::is_directory(final_path, ec))
    throw CannotWrite(fmt::format("'{}' is a folder: give a file name", path_), path_);
  sweep(final_path);
  if (!overwrite && fs::exists(final_path, ec))
    throw CannotWrite(fmt::format("'{}' exists: add --overwrite to replace it", path_), path_);
  if (::access(folder.c_str(), W_OK) != 0)
    throw CannotWrite(fmt::format("cannot write into the folder '{}': {}", folder.string(), reason()), path_);
  temporary_ = (folder / (hidden_stem(final_path) + ".tmp" + final_path.extension().string())).string();
  const std::lock_guard lock(in_the_making().list);
  in_the_making().temporaries.insert(temporary_);
}

AtomicFile::~AtomicFile() {
  if (!committed_) remove_temporaries();
  InTheMaking& making = in_the_making();
  const std::lock_guard lock(making.list);
  making.temporaries.erase(making.temporaries.find(temporary_));
}

void AtomicFile::remove_temporaries() const {
  remove_with_parts(temporary_);
}

void AtomicFile::supersede(const std::string& old_part) {
  superseded_.push_back(fs::path(old_part).filename().string().substr(fs::path(path_).stem().string().size()));
}

void AtomicFile::commit() {
  const std::vector<std::string> tails = parts_beside(temporary_);
  if (!sync_path(temporary_, O_RDONLY)) throw CannotWrite(fmt::format("cannot write '{}': {}", path_, reason()), path_);
  for (const std::string& tail : tails) {
    const std::string part = with_tail(path_, tail);
    if (!sync_path(with_tail(temporary_, tail), O_RDONLY))
      throw CannotWrite(fmt::format("cannot write '{}': {}", part, reason()), part);
    std::error_code ec;
    if (!overwrite_ && fs::exists(part, ec))
      throw CannotWrite(fmt::format("'{}' exists: add --overwrite to replace it", part), part);
  }
  {
    const std::lock_guard naming(in_the_making().naming);
    if (tails.empty() && superseded_.empty())
      take_name(temporary_, path_, overwrite_);
    else
      replace_set(tails);
    committed_ = true;
    ++committed_count;
  }
  // After this the names are on disk too. Not every file system can do it for a folder, and the output is there.
  sync_path(folder_of(path_), O_RDONLY | O_DIRECTORY);
}

void AtomicFile::replace_set(const std::vector<std::string>& tails) const {
  const std::string ending = fs::path(path_).extension().string();
  std::vector<std::string> names{ending};  // the file itself first: it goes first and comes last
  names.insert(names.end(), tails.begin(), tails.end());
  const fs::path folder = folder_of(path_);
  const auto away = [&](const std::string& tail) { return (folder / (hidden_stem(path_) + ".old" + tail)).string(); };
  std::vector<std::string> moved, placed;
  try {
    std::error_code ec;
    std::vector<std::string> leaving = names;
    for (const std::string& tail : superseded_)
      if (std::find(names.begin(), names.end(), tail) == names.end()) leaving.push_back(tail);
    for (const std::string& tail : leaving) {
      if (!overwrite_ || !fs::is_regular_file(fs::symlink_status(with_tail(path_, tail), ec))) continue;
      take_name(with_tail(path_, tail), away(tail), true);
      moved.push_back(tail);
    }
    std::rotate(names.begin(), names.begin() + 1, names.end());
    for (const std::string& tail : names) {
      const std::string& from = tail == ending ? temporary_ : with_tail(temporary_, tail);
      take_name(from, with_tail(path_, tail), overwrite_);
      placed.push_back(tail);
    }
  } catch (...) {
    for (const std::string& tail : placed) ::unlink(with_tail(path_, tail).c_str());
    std::reverse(moved.begin(), moved.end());
    for (const std::string& tail : moved) ::rename(away(tail).c_str(), with_tail(path_, tail).c_str());
    throw;
  }
  for (const std::string& tail : moved) ::unlink(away(tail).c_str());
}

void write_file(const std::string& path, std::string_view bytes, bool overwrite) {
  AtomicFile file(path, overwrite);
  const int fd = open_file(file.temporary(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
  if (fd < 0) throw CannotWrite(fmt::format("cannot write '{}': {}", path, reason()), path);
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = ::write(fd, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const std::string why = reason();
      ::close(fd);
      throw CannotWrite(fmt::format("cannot write '{}': {}", path, why), path);
    }
    at += static_cast<std::size_t>(n);
  }
  if (::close(fd) != 0) throw CannotWrite(fmt::format("cannot write '{}': {}", path, reason()), path);
  file.commit();
}

std::string read_file(const std::string& path) {
  const int fd = open_file(path, O_RDONLY | O_CLOEXEC);
  if (fd < 0) throw CannotRead(fmt::format("cannot open '{}': {}", path, reason()), path);
  struct stat info {};
  if (::fstat(fd, &info) != 0 || S_ISDIR(info.st_mode)) {
    const std::string why = S_ISDIR(info.st_mode) ? "it is a folder" : reason();
    ::close(fd);
    throw CannotRead(fmt::format("cannot read '{}': {}", path, why), path);
  }
  std::string bytes;
  if (S_ISREG(info.st_mode)) bytes.reserve(static_cast<std::size_t>(info.st_size));
  char buffer[1 << 16];
  for (;;) {
    const ssize_t n = ::read(fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const std::string why = reason();
      ::close(fd);
      throw CannotRead(fmt::format("cannot read '{}': {}", path, why), path);
    }
    if (n == 0) break;
    bytes.append(buffer, static_cast<std::size_t>(n));
  }
  ::close(fd);
  return bytes;
}

}  // namespace retalho
