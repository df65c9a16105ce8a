// The program `retalho`: its subcommands, and the one place where errors become messages and exit codes.
#include <fmt/format.h>

#include "program.h"

int main(int argc, char** argv) {
  (void)argc;
  (void)argv;
  fmt::print("retalho {}\n", RETALHO_VERSION);
  return 0;
}
