// Opens the user's browser at an address that holds a secret.
//
// The address is not put on a command line, which every user of the machine can read: the browser is given a file of
// the user's own (mode 600) that leads on to the address. The file is removed with this object.
#pragma once

#include <string>

namespace retalho::app {

class BrowserDoor {
 public:
  BrowserDoor() = default;
  ~BrowserDoor();
  BrowserDoor(const BrowserDoor&) = delete;
  BrowserDoor& operator=(const BrowserDoor&) = delete;

  /// False when no browser could be started (no xdg-open, no display).
  bool open(const std::string& address);

 private:
  std::string file_;
};

}  // namespace retalho::app
