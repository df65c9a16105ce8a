#include "retalho/raster/checked_files.h"

#include <cpl_vsi.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>

namespace retalho {
namespace {

constexpr const char* kPrefix = "/vsiretalho/";

/// The first errno of each account.
class Accounts {
 public:
  int open() {
    const std::lock_guard lock(mutex_);
    errors_[++last_] = 0;
    return last_;
  }
  void close(int account) {
    const std::lock_guard lock(mutex_);
    errors_.erase(account);
  }
  int error(int account) {
    const std::lock_guard lock(mutex_);
    const auto found = errors_.find(account);
    return found == errors_.end() ? 0 : found->second;
  }
  void charge(int account, int error) {
    const std::lock_guard lock(mutex_);
    const auto found = errors_.find(account);
    if (found != errors_.end() && found->second == 0) found->second = error != 0 ? error : EIO;
  }

 private:
  std::mutex mutex_;
  std::map<int, int> errors_;
  int last_ = 0;
};

Accounts& accounts() {
  static Accounts all;
  return all;
}

/// "12/folder/file", as GDAL hands it on without the prefix.
struct Name {
  int account = 0;
  const char* path = "";
};
Name split(const char* name) {
  char* rest = nullptr;
  const long account = std::strtol(name, &rest, 10);
  return {static_cast<int>(account), rest};
}

/// A stream of C, which wants a seek between reading and writing.
struct File {
  std::FILE* stream;
  int account;
  enum class Last { none, read, write } last = Last::none;

  bool turn(Last to) {
    const bool turned = last != Last::none && last != to;
    last = to;
    return !turned || ::fseeko(stream, 0, SEEK_CUR) == 0;
  }
  bool failed() const { return accounts().error(account) != 0; }
  bool charge() const {
    accounts().charge(account, errno);
    return false;
  }
};

File& file_of(void* handle) {
  return *static_cast<File*>(handle);
}

void* open_file(void*, const char* name, const char* access) {
  const Name n = split(name);
  errno = 0;
  std::FILE* const stream = std::fopen(n.path, access);
  if (stream == nullptr) {
    // To look for a file that is not there is no failure; not to be able to make one is.
    if (access[0] != 'r') accounts().charge(n.account, errno);
    return nullptr;
  }
  std::setvbuf(stream, nullptr, _IOFBF, std::size_t{1} << 16);
  return new File{stream, n.account};
}

int seek_file(void* handle, vsi_l_offset at, int from) {
  File& file = file_of(handle);
  file.last = File::Last::none;
  if (::fseeko(file.stream, static_cast<off_t>(at), from) == 0) return 0;
  file.charge();  // it flushes what was written
  return -1;
}

vsi_l_offset tell_file(void* handle) {
  return static_cast<vsi_l_offset>(::ftello(file_of(handle).stream));
}

std::size_t read_file(void* handle, void* to, std::size_t size, std::size_t count) {
  File& file = file_of(handle);
  if (!file.turn(File::Last::read)) return file.charge() ? 0 : 0;
  return std::fread(to, size, count, file.stream);
}

int is_at_end(void* handle) {
  return std::feof(file_of(handle).stream) != 0 ? 1 : 0;
}

std::size_t write_file(void* handle, const void* bytes, std::size_t size, std::size_t count) {
  File& file = file_of(handle);
  if (size == 0 || count == 0) return count;
  if (file.failed()) return 0;
  errno = 0;
  const std::size_t written = file.turn(File::Last::write) ? std::fwrite(bytes, size, count, file.stream) : 0;
  if (written != count) file.charge();
  return written;
}

int flush_file(void* handle) {
  const File& file = file_of(handle);
  errno = 0;
  return std::fflush(file.stream) == 0 || file.charge() ? 0 : -1;
}

int truncate_file(void* handle, vsi_l_offset size) {
  const File& file = file_of(handle);
  errno = 0;
  const bool done = std::fflush(file.stream) == 0 && ::ftruncate(fileno(file.stream), static_cast<off_t>(size)) == 0;
  return done || file.charge() ? 0 : -1;
}

int close_file(void* handle) {
  const std::unique_ptr<File> file(static_cast<File*>(handle));
  errno = 0;
  return std::fclose(file->stream) == 0 || file->charge() ? 0 : -1;
}

int stat_file(void*, const char* name, VSIStatBufL* out, int) {
  return ::stat64(split(name).path, out);
}

int unlink_file(void*, const char* name) {
  return ::unlink(split(name).path);
}

int rename_file(void*, const char* from, const char* to) {
  const Name n = split(from);
  errno = 0;
  if (std::rename(n.path, split(to).path) == 0) return 0;
  accounts().charge(n.account, errno);
  return -1;
}

void install() {
  static std::once_flag once;
  std::call_once(once, [] {
    VSIFilesystemPluginCallbacksStruct* const calls = VSIAllocFilesystemPluginCallbacksStruct();
    calls->open = open_file;
    calls->seek = seek_file;
    calls->tell = tell_file;
    calls->read = read_file;
    calls->eof = is_at_end;
    calls->write = write_file;
    calls->flush = flush_file;
    calls->truncate = truncate_file;
    calls->close = close_file;
    calls->stat = stat_file;
    calls->unlink = unlink_file;
    calls->rename = rename_file;
    VSIInstallPluginHandler(kPrefix, calls);
    VSIFreeFilesystemPluginCallbacksStruct(calls);
  });
}

}  // namespace

CheckedFiles::CheckedFiles() : account_(accounts().open()) {
  install();
}
CheckedFiles::~CheckedFiles() {
  accounts().close(account_);
}

std::string CheckedFiles::name(const std::string& path) const {
  return fmt::format("{}{}{}", kPrefix, account_, std::filesystem::absolute(path).string());
}

int CheckedFiles::error() const {
  return accounts().error(account_);
}

bool CheckedFiles::serves(const std::string& driver) {
  constexpr std::array kServed = {"GTiff", "COG",  "AAIGrid", "PNG",     "JPEG",     "ENVI",          "EHdr", "XYZ",
                                  "GSAG",  "GSBG", "GS7BG",   "HFA",     "BT",       "RST",           "ERS",  "PNM",
                                  "SAGA",  "GTX",  "SRTMHGT", "USGSDEM", "TERRAGEN", "ESRI Shapefile"};
  return std::any_of(kServed.begin(), kServed.end(), [&](const char* name) { return driver == name; });
}

MemoryFile::MemoryFile(const std::string& ending) {
  static std::atomic<unsigned> count{0};
  name_ = fmt::format("/vsimem/retalho-{}{}", count++, ending);
}
MemoryFile::~MemoryFile() {
  VSIUnlink(name_.c_str());
}

std::string_view MemoryFile::bytes() const {
  vsi_l_offset size = 0;
  const GByte* const data = VSIGetMemFileBuffer(name_.c_str(), &size, FALSE);
  return {reinterpret_cast<const char*>(data), data == nullptr ? 0 : static_cast<std::size_t>(size)};
}

}  // namespace retalho
