#include "browser.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

extern char** environ;  // NOLINT: the C library's name

namespace retalho::app {

BrowserDoor::~BrowserDoor() {
  if (!file_.empty()) unlink(file_.c_str());
}

bool BrowserDoor::open(const std::string& address) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return false;
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  const std::filesystem::path folder = runtime && *runtime ? runtime : "/tmp";
  std::string name = (folder / "retalho-view-XXXXXX.html").string();
  const int fd = mkstemps(name.data(), 5);  // mode 600
  if (fd < 0) return false;
  file_ = name;
  const std::string page = fmt::format(
      "<!doctype html><meta charset=utf-8><title>Retalho</title><meta http-equiv=refresh content=\"0; url={0}\">"
      "<a href=\"{0}\">Retalho</a>\n",
      address);
  const bool written = write(fd, page.data(), page.size()) == static_cast<ssize_t>(page.size());
  close(fd);
  if (!written) return false;
  const std::string program = "xdg-open";
  char* arguments[] = {const_cast<char*>(program.c_str()), file_.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments, environ) != 0) return false;
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace retalho::app
