// Outputs are complete or absent; an existing file is replaced only when asked.
#include "retalho/core/atomic_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "retalho/core/error.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("retalho-atomic-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string name(const char* file) const { return (folder_ / file).string(); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

TEST_F(AtomicFileTest, WritesAndReadsBack) {
  const std::string bytes("a\0b\nc", 5);
  write_file(name("x.bin"), bytes, false);
  EXPECT_EQ(read_file(name("x.bin")), bytes);
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFileTest, RefusesToReplaceUnlessAsked) {
  write_file(name("x"), "old", false);
  EXPECT_THROW(write_file(name("x"), "new", false), CannotWrite);
  EXPECT_EQ(read_file(name("x")), "old");
  write_file(name("x"), "new", true);
  EXPECT_EQ(read_file(name("x")), "new");
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFileTest, LeavesNothingWithoutCommit) {
  {
    AtomicFile file(name("x.tif"), false);
    EXPECT_TRUE(file.temporary().ends_with(".tif"));
    write_file(file.temporary(), "half", true);
  }
  EXPECT_EQ(files(), 0U);
}

TEST_F(AtomicFileTest, NamesTheMissingFolder) {
  try {
    write_file(name("no/such/x"), "y", false);
    FAIL();
  } catch (const CannotWrite& e) {
    EXPECT_NE(std::string(e.what()).find("does not exist"), std::string::npos) << e.what();
  }
  EXPECT_THROW(read_file(name("nothing")), CannotRead);
  EXPECT_THROW(read_file(folder_.string()), CannotRead);
}

}  // namespace
}  // namespace retalho
