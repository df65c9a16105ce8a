// What the benchmarks share: where real data lies, which grids there are, CPU seconds.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace retalho::bench {

/// $RETALHO_DATA, or shared/data beside the checkout.
inline std::filesystem::path data_folder() {
  const char* folder = std::getenv("RETALHO_DATA");
  return folder != nullptr ? std::filesystem::path(folder)
                           : std::filesystem::path(RETALHO_BENCH_DIR) / "../../shared/data";
}
inline std::string dem(const std::string& name) {
  return (data_folder() / "dem" / name).string();
}

/// The demo's grid, then every elevation grid of the data folder by name.
inline std::vector<std::filesystem::path> grids() {
  std::vector<std::filesystem::path> result{std::filesystem::path(RETALHO_BENCH_DIR) / "../examples/jacksboro.vrt"};
  for (const auto& entry : std::filesystem::directory_iterator(data_folder() / "dem")) {
    const std::string ending = entry.path().extension().string();
    const bool is_grid = ending == ".tif" || ending == ".hgt" || ending == ".zip" || ending == ".dem" ||
                         ending == ".bil" || entry.path().filename() == "crater.pgm";
    if (is_grid) result.push_back(entry.path());
  }
  std::sort(result.begin() + 1, result.end());
  return result;
}

/// Of this process, all threads.
inline double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace retalho::bench
