// The tests' own tools do what they say.
#include "support/support.h"

#include <gtest/gtest.h>

namespace retalho {
namespace {

TEST(ScratchFolder, IsEmptyThenGone) {
  std::filesystem::path path;
  {
    const test::ScratchFolder folder;
    path = folder.path();
    EXPECT_EQ(folder.entries(), 0U);
    EXPECT_EQ(test::bytes_of(folder.put("below/a.txt", std::string("a\0b", 3))), std::string("a\0b", 3));
    EXPECT_EQ(folder.entries(), 1U);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(Random, RepeatsAndStaysInItsRange) {
  test::Random one(7), two(7), other(8);
  int differences = 0;
  for (int i = 0; i < 1000; ++i) {
    const double value = one.uniform(-2, 3);
    EXPECT_EQ(value, two.uniform(-2, 3));
    EXPECT_GE(value, -2);
    EXPECT_LT(value, 3);
    if (value != other.uniform(-2, 3)) ++differences;
  }
  EXPECT_GT(differences, 990);
}

}  // namespace
}  // namespace retalho
