// What the tests of every room share: real data that may be missing, a folder that goes away, and seeds that are
// printed. Include as "support/support.h".
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>

#include "support/paths.h"

namespace retalho::test {

/// Where the real data lies, which is no part of the repository: $RETALHO_DATA, or shared/data beside the checkout.
inline std::filesystem::path data_folder() {
  if (const char* folder = std::getenv("RETALHO_DATA"); folder != nullptr && *folder != '\0') return folder;
  return (std::filesystem::path(source_folder()) / ".." / "shared" / "data").lexically_normal();
}

/// The path of `name` under data_folder() ("dem/crater.pgm"). Where the file may be missing, ask for it with
/// RETALHO_DATA_FILE, which skips the test.
inline std::filesystem::path data_file(const std::string& name) {
  return data_folder() / name;
}

/// An empty folder of its own that is removed, with what is in it, at the end of its scope.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "retalho-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a scratch folder " + name);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  /// Writes a file of these bytes and returns its path.
  std::string put(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream out(file, std::ios::binary);
    out << bytes;
    if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
    return file.string();
  }

  /// How many files and folders are in it (not counted below): a failed write must leave none behind.
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

/// All the bytes of a file.
inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The seed of this run's random tests: $RETALHO_SEED, or one that never changes, so that a plain run is repeatable.
inline std::uint64_t test_seed() {
  if (const char* seed = std::getenv("RETALHO_SEED"); seed != nullptr && *seed != '\0')
    return std::strtoull(seed, nullptr, 0);
  return 20240229;
}

/// How many times longer random loops run: $RETALHO_SOAK (1: smoke).
inline int soak() {
  if (const char* factor = std::getenv("RETALHO_SOAK"); factor != nullptr && *factor != '\0')
    return std::max(1, std::atoi(factor));
  return 1;
}

/// Random numbers for one test, and its seed in the message of every failure while it lives:
///   Random random;  double x = random.uniform(-1, 1);  auto k = random.index(10);
class Random {
 public:
  explicit Random(std::uint64_t stream = 0)
      : seed_(test_seed() + stream),
        engine_(seed_),
        trace_(__FILE__, __LINE__, "random test: repeat with RETALHO_SEED=" + std::to_string(test_seed())) {}

  /// In [low, high).
  double uniform(double low = 0, double high = 1) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  /// In [0, count); count > 0.
  std::size_t index(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  bool chance(double probability) { return uniform() < probability; }
  std::uint64_t seed() const { return seed_; }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::uint64_t seed_;
  std::mt19937_64 engine_;
  ::testing::ScopedTrace trace_;
};

}  // namespace retalho::test

/// Declares `path`, the real data file `name`, or skips this test and says which file is missing (the runner counts
/// the skipped tests). Use it in the test's own body:  RETALHO_DATA_FILE(dem, "dem/crater.pgm");
#define RETALHO_DATA_FILE(path, name)                                 \
  const std::string path = ::retalho::test::data_file(name).string(); \
  if (!::std::filesystem::exists(path))                               \
  GTEST_SKIP() << "real data missing: " << path << " (set RETALHO_DATA to the folder that holds " << (name) << ")"
