#include "retalho/core/abandon.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "retalho/core/atomic_file.h"
#include "support/support.h"

namespace retalho {
namespace {

/// What a program does that must end now; the exit code says what it found.
[[noreturn]] void abandon_in_the_middle(const test::ScratchFolder& folder) {
  const std::uint64_t before = outputs_committed();
  write_file(folder / "done.txt", "whole", false);
  AtomicFile shape(folder / "a.shp", true), other(folder / "b.txt", true);
  for (const std::string& name : {shape.temporary(), other.temporary(),
                                  std::filesystem::path(shape.temporary()).replace_extension(".dbf").string()})
    std::ofstream(name) << "half";
  if (outputs_committed() != before + 1) ::_exit(1);
  ::_exit(abandon_outputs() ? 7 : 2);
}

TEST(Abandon, OutputsInTheMakingAreRemovedWithTheirPartsAndFinishedOnesStay) {
  const test::ScratchFolder folder;
  { std::ofstream(folder / "b.txt") << "the old one"; }
  EXPECT_EXIT(abandon_in_the_middle(folder), testing::ExitedWithCode(7), "");
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"b.txt", "done.txt"}));
  std::ifstream old(folder / "b.txt");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(old), {}), "the old one");
}

}  // namespace
}  // namespace retalho
