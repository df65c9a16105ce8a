// Outputs are complete or absent; an existing file is replaced only when asked.
#include "retalho/core/atomic_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "retalho/core/error.h"
#include "support/errors.h"

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

TEST_F(AtomicFileTest, PartsShareTheFilesFate) {
  const auto put_parts = [](const AtomicFile& file) {
    const std::string stem = file.temporary().substr(0, file.temporary().size() - 4);
    write_file(file.temporary(), "shape", true);
    write_file(stem + ".dbf", "table", true);
    write_file(stem + ".shp.xml", "words", true);
  };
  {
    AtomicFile file(name("x.shp"), false);
    put_parts(file);
  }
  EXPECT_EQ(files(), 0U);
  {
    AtomicFile file(name("x.shp"), false);
    put_parts(file);
    file.commit();
  }
  EXPECT_EQ(files(), 3U);
  EXPECT_EQ(read_file(name("x.dbf")), "table");
  EXPECT_EQ(read_file(name("x.shp.xml")), "words");

  // A part whose name is taken: nothing is written, nothing is left, the old one stands.
  fs::remove(name("x.shp"));
  write_file(name("x.dbf"), "mine", true);
  {
    AtomicFile file(name("x.shp"), false);
    put_parts(file);
    EXPECT_THROW(file.commit(), CannotWrite);
  }
  EXPECT_EQ(files(), 2U);
  EXPECT_EQ(read_file(name("x.dbf")), "mine");
  {
    AtomicFile file(name("x.shp"), true);
    put_parts(file);
    file.commit();
  }
  EXPECT_EQ(read_file(name("x.dbf")), "table");

  // A part that cannot get its name (a folder has it): said, and nothing of ours is left beside it.
  fs::remove(name("x.shp"));
  fs::remove(name("x.dbf"));
  fs::create_directory(name("x.dbf"));
  {
    AtomicFile file(name("x.shp"), true);
    put_parts(file);
    EXPECT_THROW(file.commit(), CannotWrite);
  }
  EXPECT_FALSE(fs::exists(name("x.shp")));
  EXPECT_EQ(files(), 2U);  // the folder, and the old x.shp.xml
}

TEST_F(AtomicFileTest, ASetThatCannotBeReplacedIsBackAsItWas) {
  // The second part's name is a folder's: by then the old file and the first part are away.
  write_file(name("x.shp"), "old shape", true);
  write_file(name("x.aaa"), "old part", true);
  fs::create_directory(name("x.zzz"));
  {
    AtomicFile file(name("x.shp"), true);
    const std::string stem = file.temporary().substr(0, file.temporary().size() - 4);
    for (const char* ending : {".shp", ".aaa", ".zzz"}) write_file(stem + ending, "new", true);
    EXPECT_THROW(file.commit(), CannotWrite);
  }
  EXPECT_EQ(read_file(name("x.shp")), "old shape");
  EXPECT_EQ(read_file(name("x.aaa")), "old part");
  EXPECT_EQ(files(), 3U);
}

TEST_F(AtomicFileTest, SupersededPartsGoWithTheOldFile) {
  write_file(name("x.tif"), "old", true);
  write_file(name("x.tif.aux.xml"), "old statistics", true);
  {
    AtomicFile file(name("x.tif"), true);
    file.supersede(name("x.tif.aux.xml"));
    write_file(file.temporary(), "new", true);
  }
  EXPECT_EQ(read_file(name("x.tif.aux.xml")), "old statistics");
  {
    AtomicFile file(name("x.tif"), true);
    file.supersede(name("x.tif.aux.xml"));
    write_file(file.temporary(), "new", true);
    file.commit();
  }
  EXPECT_EQ(read_file(name("x.tif")), "new");
  EXPECT_EQ(files(), 1U);
}

TEST_F(AtomicFileTest, WhatAKilledProcessLeftIsSwept) {
  const auto killed = [&](bool away) {
    const pid_t child = ::fork();
    if (child == 0) {
      AtomicFile file(name("x.shp"), true);
      std::ofstream(file.temporary()) << "half";
      std::string old = file.temporary();
      old.replace(old.rfind(".tmp"), 4, ".old");
      if (away) ::rename(name("x.shp").c_str(), old.c_str());
      ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
  };
  write_file(name("x.shp"), "old", true);
  write_file(name("x.y.shp"), "of another", true);
  killed(false);
  ASSERT_EQ(files(), 3U);
  { const AtomicFile file(name("x.y.shp"), true); }
  EXPECT_EQ(files(), 3U);  // not its own
  { const AtomicFile file(name("x.shp"), true); }
  EXPECT_EQ(files(), 2U);
  killed(true);
  EXPECT_FALSE(fs::exists(name("x.shp")));
  { const AtomicFile file(name("x.shp"), true); }
  EXPECT_EQ(read_file(name("x.shp")), "old");
  EXPECT_EQ(files(), 2U);
  // One in the making by a process that lives stays.
  const AtomicFile mine(name("x.shp"), true);
  std::ofstream(mine.temporary()) << "in the making";
  { const AtomicFile file(name("x.tif"), true); }
  EXPECT_TRUE(fs::exists(mine.temporary()));
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

TEST_F(AtomicFileTest, WhatCannotBeWrittenIsNamed) {
  test::expect_refused<CannotWrite>({
      {"'' is not a file name: give the output's name", [] { AtomicFile("", false); }},
      {"cannot rename to '",
       [&] {
         AtomicFile file(name("x"), true);
         write_file(file.temporary(), "new", true);
         fs::create_directory(name("x"));  // after the name was found free
         file.commit();
       }},
  });
  EXPECT_EQ(files(), 1U) << "the folder alone";
}

TEST_F(AtomicFileTest, AFolderThatMayNotBeWrittenIntoIsNamed) {
  // In a child that is nobody: what may not be written does not hinder root.
  fs::permissions(folder_,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (::getuid() == 0 && ::setuid(kNobody) != 0) ::_exit(2);
    try {
      const AtomicFile file(name("x"), false);
    } catch (const CannotWrite& error) {
      ::_exit(test::holds(error.what(), "cannot write into the folder '") ? 0 : 3);
    }
    ::_exit(4);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace retalho
