#include "support/paths.h"

namespace retalho::test {

std::string source_folder() {
  return RETALHO_SOURCE_DIR;
}

std::string program_path() {
  return RETALHO_PROGRAM;
}

}  // namespace retalho::test
