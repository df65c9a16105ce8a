// A library for LD_PRELOAD that makes the n-th operation of a kind fail, on files in one folder only, so that tests can
// walk through every fault that a disk can have. faults.py drives it.
//
//   RETALHO_FAULT_FOLDER=/scratch/out      files below it are watched (a path as realpath gives it)
//   RETALHO_FAULT=write:3:ENOSPC:on        the kind, the number from 1, the error, and "once" or "on" (from then on)
//   RETALHO_FAULT_LOG=/scratch/log         gets one line for each fault, and at exit how many of each kind there were
//
// Kinds: open (for writing), write (write, pwrite, fwrite, ftruncate, and the flush of a buffered stream in fflush,
// fseek or fclose), sync (fsync, fdatasync), rename (rename, link), alloc (an allocation of RETALHO_FAULT_BYTES or
// more). Errors: ENOSPC, EIO, EINTR, and SHORT, where half of the bytes are written and their count is returned. Two
// are done to the program in front of the operation instead, which then goes on: KILL (SIGKILL) and INT (SIGINT).
//
// Calls of glibc's own (fwrite to write) do not come past here, hence the stream functions.
#include <dlfcn.h>
#include <fcntl.h>
#include <stdio_ext.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" {  // NOLINTBEGIN(readability-identifier-naming): glibc's names
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
}  // NOLINTEND(readability-identifier-naming)

namespace {

enum Kind { kOpen, kWrite, kSync, kRename, kAlloc, kKinds };
constexpr const char* kNames[kKinds] = {"open", "write", "sync", "rename", "alloc"};
constexpr int kShort = -1, kKill = -2, kInterrupt = -3;

std::atomic<long> counts[kKinds];
Kind wanted = kKinds;
long number = 0, least_bytes = 1 << 16;
int error = 0;
bool stays = false;
bool ready = false;
char folder[PATH_MAX];

template <class F>
F real(F, const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}
#define REAL(name) (real(&::name, #name))

void log_line(const char* words, long value) {
  const char* const path = std::getenv("RETALHO_FAULT_LOG");
  if (path == nullptr) return;
  char line[128];
  const int size = std::snprintf(line, sizeof line, "%s %ld\n", words, value);
  static const auto open_file = reinterpret_cast<int (*)(const char*, int, ...)>(dlsym(RTLD_NEXT, "open"));
  static const auto write_bytes = REAL(write);
  const int fd = open_file(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (fd < 0) return;
  if (write_bytes(fd, line, static_cast<size_t>(size)) < 0) std::abort();
  close(fd);
}

__attribute__((constructor)) void start() {
  if (const char* const given = std::getenv("RETALHO_FAULT_FOLDER")) std::snprintf(folder, sizeof folder, "%s/", given);
  if (const char* const given = std::getenv("RETALHO_FAULT_BYTES")) least_bytes = std::atol(given);
  if (const char* const given = std::getenv("RETALHO_FAULT")) {
    char kind[16] = "", name[16] = "", how[16] = "";
    if (std::sscanf(given, "%15[^:]:%ld:%15[^:]:%15s", kind, &number, name, how) != 4) std::abort();
    for (int k = 0; k < kKinds; ++k)
      if (std::strcmp(kind, kNames[k]) == 0) wanted = static_cast<Kind>(k);
    error = std::strcmp(name, "ENOSPC") == 0  ? ENOSPC
            : std::strcmp(name, "EIO") == 0   ? EIO
            : std::strcmp(name, "EINTR") == 0 ? EINTR
            : std::strcmp(name, "SHORT") == 0 ? kShort
            : std::strcmp(name, "KILL") == 0  ? kKill
            : std::strcmp(name, "INT") == 0   ? kInterrupt
                                              : 0;
    stays = std::strcmp(how, "on") == 0;
    if (wanted == kKinds || error == 0) std::abort();
  }
  ready = true;
}

__attribute__((destructor)) void finish() {
  for (int k = 0; k < kKinds; ++k) log_line(kNames[k], counts[k]);
}

/// Counts one operation of this kind; whether it is to fail.
bool strikes(Kind kind) {
  if (!ready) return false;
  const long n = ++counts[kind];
  if (kind != wanted || n < number || (n > number && !stays)) return false;
  const int saved = errno;
  log_line("fault", n);
  if (error == kKill || error == kInterrupt) kill(getpid(), error == kKill ? SIGKILL : SIGINT);
  errno = saved;
  return error != kKill && error != kInterrupt;
}

bool is_ours(const char* path) {
  if (folder[0] == '\0' || path == nullptr) return false;
  char whole[2 * PATH_MAX];
  if (path[0] == '/') {
    std::snprintf(whole, sizeof whole, "%s", path);
  } else {
    char here[PATH_MAX];
    if (getcwd(here, sizeof here) == nullptr) return false;
    std::snprintf(whole, sizeof whole, "%s/%s", here, path);
  }
  return std::strncmp(whole, folder, std::strlen(folder)) == 0;
}

bool is_ours(int fd) {
  if (folder[0] == '\0' || fd < 3) return false;
  char link[64], path[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t size = readlink(link, path, sizeof path - 1);
  if (size <= 0) return false;
  path[size] = '\0';
  return is_ours(path);
}

bool is_ours(FILE* stream) {
  return is_ours(fileno(stream));
}

bool writes(int flags) {
  return (flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0;
}

int open_with(const char* name, const char* path, int flags, mode_t mode) {
  if (writes(flags) && is_ours(path) && strikes(kOpen)) {
    errno = error == kShort ? EIO : error;
    return -1;
  }
  return reinterpret_cast<int (*)(const char*, int, ...)>(dlsym(RTLD_NEXT, name))(path, flags, mode);
}

FILE* fopen_with(const char* name, const char* path, const char* mode) {
  if (std::strpbrk(mode, "wa+") != nullptr && is_ours(path) && strikes(kOpen)) {
    errno = error == kShort ? EIO : error;
    return nullptr;
  }
  return reinterpret_cast<FILE* (*)(const char*, const char*)>(dlsym(RTLD_NEXT, name))(path, mode);
}

/// A flush that fails: what was buffered is lost, as it is when write() fails for good.
bool flush_fails(FILE* stream) {
  if (stream == nullptr || __fpending(stream) == 0 || !is_ours(stream) || !strikes(kWrite)) return false;
  __fpurge(stream);
  stream->_flags |= 0x20;  // ferror
  errno = error == kShort ? ENOSPC : error;
  return true;
}

bool alloc_fails(size_t bytes) {
  if (!ready || wanted != kAlloc || bytes < static_cast<size_t>(least_bytes) || !strikes(kAlloc)) return false;
  errno = ENOMEM;
  return true;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return open_with("open", path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return open_with("open64", path, flags, mode);
}
FILE* fopen(const char* path, const char* mode) {
  return fopen_with("fopen", path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  return fopen_with("fopen64", path, mode);
}

ssize_t write(int fd, const void* bytes, size_t size) {
  static const auto next = REAL(write);
  if (size == 0 || !is_ours(fd) || !strikes(kWrite)) return next(fd, bytes, size);
  if (error == kShort) return next(fd, bytes, (size + 1) / 2);
  errno = error;
  return -1;
}
ssize_t writev(int fd, const struct iovec* parts, int count) {
  static const auto next = REAL(writev);
  if (!is_ours(fd) || !strikes(kWrite)) return next(fd, parts, count);
  if (error == kShort && count > 0) return next(fd, parts, (count + 1) / 2);
  errno = error;
  return -1;
}
ssize_t pwrite(int fd, const void* bytes, size_t size, off_t at) {
  static const auto next = REAL(pwrite);
  if (size == 0 || !is_ours(fd) || !strikes(kWrite)) return next(fd, bytes, size, at);
  if (error == kShort) return next(fd, bytes, (size + 1) / 2, at);
  errno = error;
  return -1;
}
ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t at) {
  static const auto next = REAL(pwrite64);
  if (size == 0 || !is_ours(fd) || !strikes(kWrite)) return next(fd, bytes, size, at);
  if (error == kShort) return next(fd, bytes, (size + 1) / 2, at);
  errno = error;
  return -1;
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* stream) {
  static const auto next = REAL(fwrite);
  if (size == 0 || count == 0 || !is_ours(stream) || !strikes(kWrite)) return next(bytes, size, count, stream);
  size_t done = 0;
  if (error == kShort) done = next(bytes, size, count / 2, stream);
  stream->_flags |= 0x20;
  errno = error == kShort ? ENOSPC : error;
  return done;
}
int ftruncate(int fd, off_t size) {
  static const auto next = REAL(ftruncate);
  if (!is_ours(fd) || !strikes(kWrite)) return next(fd, size);
  errno = error == kShort ? EIO : error;
  return -1;
}
int ftruncate64(int fd, off64_t size) {
  static const auto next = REAL(ftruncate64);
  if (!is_ours(fd) || !strikes(kWrite)) return next(fd, size);
  errno = error == kShort ? EIO : error;
  return -1;
}
int fflush(FILE* stream) {
  static const auto next = REAL(fflush);
  return flush_fails(stream) ? EOF : next(stream);
}
int fseek(FILE* stream, long at, int from) {
  static const auto next = REAL(fseek);
  return flush_fails(stream) ? -1 : next(stream, at, from);
}
int fseeko(FILE* stream, off_t at, int from) {
  static const auto next = REAL(fseeko);
  return flush_fails(stream) ? -1 : next(stream, at, from);
}
int fseeko64(FILE* stream, off64_t at, int from) {
  static const auto next = REAL(fseeko64);
  return flush_fails(stream) ? -1 : next(stream, at, from);
}
int fclose(FILE* stream) {
  static const auto next = REAL(fclose);
  if (!flush_fails(stream)) return next(stream);
  const int saved = errno;
  next(stream);
  errno = saved;
  return EOF;
}

int fsync(int fd) {
  static const auto next = REAL(fsync);
  if (!is_ours(fd) || !strikes(kSync)) return next(fd);
  errno = error == kShort ? EIO : error;
  return -1;
}
int fdatasync(int fd) {
  static const auto next = REAL(fdatasync);
  if (!is_ours(fd) || !strikes(kSync)) return next(fd);
  errno = error == kShort ? EIO : error;
  return -1;
}
int rename(const char* from, const char* to) {
  static const auto next = REAL(rename);
  if (!is_ours(to) || !strikes(kRename)) return next(from, to);
  errno = error == kShort ? EIO : error;
  return -1;
}
int link(const char* from, const char* to) {
  static const auto next = REAL(link);
  if (!is_ours(to) || !strikes(kRename)) return next(from, to);
  errno = error == kShort ? EIO : error;
  return -1;
}

void* malloc(size_t bytes) {
  return alloc_fails(bytes) ? nullptr : __libc_malloc(bytes);
}
void* calloc(size_t count, size_t bytes) {
  return alloc_fails(count * bytes) ? nullptr : __libc_calloc(count, bytes);
}
void* realloc(void* old, size_t bytes) {
  return alloc_fails(bytes) ? nullptr : __libc_realloc(old, bytes);
}
void* aligned_alloc(size_t alignment, size_t bytes) {
  return alloc_fails(bytes) ? nullptr : __libc_memalign(alignment, bytes);
}
int posix_memalign(void** out, size_t alignment, size_t bytes) {
  if (alloc_fails(bytes)) return ENOMEM;
  void* const p = __libc_memalign(alignment, bytes);
  if (p == nullptr) return ENOMEM;
  *out = p;
  return 0;
}

}  // extern "C"
