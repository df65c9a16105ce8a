// Runs the program itself, as a user does, and the inputs that its tests are made of.
#pragma once

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/paths.h"
#include "support/support.h"

namespace retalho::test {

struct Outcome {
  int code = -1;  ///< the exit code; -1 when a signal ended the program
  std::string out, err;
  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

inline std::string slurp(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// `arguments` as a shell would take them, run inside `folder`; its two outputs are kept apart in files outside of it.
inline Outcome run(const ScratchFolder& folder, const std::string& arguments, const std::string& redirect = "") {
  const ScratchFolder outputs;
  const std::string command = fmt::format("cd '{}' && '{}' {} >'{}' 2>'{}' {}", folder.path().string(), program_path(),
                                          arguments, outputs / "out", outputs / "err", redirect);
  const int status = std::system(command.c_str());
  Outcome outcome;
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  outcome.out = slurp(outputs / "out");
  outcome.err = slurp(outputs / "err");
  return outcome;
}

/// An ASCII grid (GDAL's AAIGrid) of height(column, row), cells 10 wide, lower left corner at (1000, 2000); NaN is
/// void.
inline std::string ascii_grid(int columns, int rows, const std::function<double(int, int)>& height) {
  std::string text = fmt::format(
      "ncols {}\nnrows {}\nxllcorner 1000\nyllcorner 2000\ncellsize 10\nNODATA_value -9999\n", columns, rows);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const double h = height(c, r);
      text += fmt::format("{}{}", c == 0 ? "" : " ", h == h ? h : -9999);
    }
    text += '\n';
  }
  return text;
}

/// Smooth hills of integer heights, 0 to about 200.
inline double hills(int c, int r) {
  return static_cast<double>(
      static_cast<int>(100 + 60 * std::sin(c * 0.17) * std::cos(r * 0.13) + 40 * std::sin(c * 0.05 + r * 0.07)));
}

}  // namespace retalho::test
