#include "retalho/mesh/mesh_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "retalho/core/error.h"

namespace retalho {
namespace {

[[noreturn]] void fail(const std::string& name) {
  throw CannotWrite(fmt::format("cannot write '{}': {}", name, std::strerror(errno)), name);
}

}  // namespace

MeshFile::MeshFile(const std::string& path, std::string name)
    : name_(std::move(name)), number_(open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600)) {
  if (number_ < 0) fail(name_);
  unlink(path.c_str());
}

MeshFile::~MeshFile() {
  close(number_);
}

void MeshFile::put(const void* bytes, std::size_t size, std::uint64_t at) const {
  const auto* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t done = pwrite(number_, from, size, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail(name_);
    from += done;
    at += static_cast<std::uint64_t>(done);
    size -= static_cast<std::size_t>(done);
  }
}

void MeshFile::get(void* bytes, std::size_t size, std::uint64_t at) const {
  auto* to = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t done = pread(number_, to, size, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail(name_);
    to += done;
    at += static_cast<std::uint64_t>(done);
    size -= static_cast<std::size_t>(done);
  }
}

}  // namespace retalho
