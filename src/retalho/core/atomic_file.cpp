#include "retalho/core/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

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
  if (!committed_) ::unlink(temporary_.c_str());
}

void AtomicFile::commit() {
  if (!sync_path(temporary_, O_RDONLY)) throw CannotWrite(fmt::format("cannot write '{}': {}", path_, reason()), path_);
  // link() refuses an existing name, so that two runs without --overwrite cannot replace each other's result.
  if (!overwrite_ && ::link(temporary_.c_str(), path_.c_str()) == 0) {
    ::unlink(temporary_.c_str());
  } else if (!overwrite_ && errno == EEXIST) {
    throw CannotWrite(fmt::format("'{}' exists: add --overwrite to replace it", path_), path_);
  } else if (::rename(temporary_.c_str(), path_.c_str()) != 0) {
    throw CannotWrite(fmt::format("cannot rename to '{}': {}", path_, reason()), path_);
  }
  committed_ = true;
  const std::string folder = fs::path(path_).has_parent_path() ? fs::path(path_).parent_path().string() : ".";
  sync_path(folder, O_RDONLY | O_DIRECTORY);
}

std::set<std::string> sidecars(const std::string& file) {
  std::set<std::string> found;
  const fs::path path(file);
  const std::string stem = path.stem().string();
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(stem) && name != path.filename().string()) found.insert(name.substr(stem.size()));
  }
  return found;
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
