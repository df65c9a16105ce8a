// Vector files are whole or absent: every format on a disk that is too small for it.
#include "retalho/level/write_vector.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "contour_support.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/terrain/bicubic.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;

/// A file of this process ends at `bytes`: a write past it fails with EFBIG, as one on a full disk does with ENOSPC.
class SmallFiles {
 public:
  explicit SmallFiles(rlim_t bytes) : old_signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit small{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallFiles() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_signal_);
  }
  SmallFiles(const SmallFiles&) = delete;
  SmallFiles& operator=(const SmallFiles&) = delete;

 private:
  rlimit old_{};
  void (*old_signal_)(int);
};

class WriteVector : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("retalho-vector-" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    // Enough lines that no buffer of the C library or of a driver holds them all.
    const Raster raster =
        test::contour_raster(80, 80, [](int c, int r) { return 40 * std::sin(0.7 * c) * std::cos(0.6 * r); });
    set_ = trace_contours(make_bicubic(raster), {-30, -20, -10, 0, 10, 20, 30}, {.tolerance = 0.01});
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path() const { return (folder_ / (std::string("lines") + GetParam())).string(); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
  ContourSet set_;
};

TEST_P(WriteVector, AFullDiskIsSaidAndLeavesTheOldFile) {
  write_contours(set_, Georef{}, path());
  const std::string old = read_file(path());
  const std::size_t parts = files();
  ASSERT_GT(old.size(), 100'000U);
  // Cut in the middle, and shortly before the end, where only closing the file would notice.
  for (const std::size_t cut : {std::size_t{0}, old.size() / 2, old.size() - 3}) {
    const SmallFiles small(cut);
    EXPECT_THROW(write_contours(set_, Georef{}, path(), VectorOptions{.overwrite = true}), CannotWrite)
        << "at " << cut << " bytes";
  }
  EXPECT_EQ(read_file(path()), old);
  EXPECT_EQ(files(), parts) << "a temporary file was left";
}

INSTANTIATE_TEST_SUITE_P(Formats, WriteVector, testing::Values(".gpkg", ".geojson", ".shp", ".dxf"),
                         [](const auto& name) { return std::string(name.param + 1); });

}  // namespace
}  // namespace retalho
