#include "retalho/core/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "retalho/core/error.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;

std::string reason() {
  return std::strerror(errno);
}

/// Flushes a file or a folder to disk. Returns false with errno set.
bool sync_path(const std::string& path, int flags) {
  const int fd = ::open(path.c_str(), flags);
  if (fd < 0) return false;
  const bool done = ::fsync(fd) == 0;
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

}  // namespace

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
  if (!overwrite && fs::exists(final_path, ec))
    throw CannotWrite(fmt::format("'{}' exists: add --overwrite to replace it", path_), path_);
  if (::access(folder.c_str(), W_OK) != 0)
    throw CannotWrite(fmt::format("cannot write into the folder '{}': {}", folder.string(), reason()), path_);
  temporary_ =
      (folder / fmt::format(".{}.{}.tmp{}", final_path.stem().string(), ::getpid(), final_path.extension().string()))
          .string();
}

AtomicFile::~AtomicFile() {
  if (!committed_) remove_temporaries();
}

void AtomicFile::remove_temporaries() const {
  for (const std::string& tail : parts_beside(temporary_)) ::unlink(with_tail(temporary_, tail).c_str());
  ::unlink(temporary_.c_str());
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
  for (const std::string& tail : tails) take_name(with_tail(temporary_, tail), with_tail(path_, tail), overwrite_);
  take_name(temporary_, path_, overwrite_);
  committed_ = true;
  sync_path(folder_of(path_), O_RDONLY | O_DIRECTORY);
}

void write_file(const std::string& path, std::string_view bytes, bool overwrite) {
  AtomicFile file(path, overwrite);
  const int fd = ::open(file.temporary().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
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
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
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
