#include "retalho/core/memory.h"

#include <gtest/gtest.h>

#include <vector>

#include "retalho/core/error.h"
#include "support/errors.h"

namespace retalho {
namespace {

constexpr std::uint64_t kMegabyte = 1 << 20;

TEST(Memory, TheMachineHasSomeAndThisProcessTakesAPartOfIt) {
  EXPECT_GT(whole_memory(), 64 * kMegabyte);
  EXPECT_LE(available_memory(), whole_memory());
  EXPECT_GT(resident_memory(), kMegabyte);
  EXPECT_LT(resident_memory(), whole_memory());
}

TEST(Memory, WhatIsResidentGrowsWithWhatIsTouched) {
  const std::uint64_t before = resident_memory();
  const std::vector<char> held(96 * kMegabyte, 1);
  EXPECT_GT(resident_memory(), before + 64 * kMegabyte) << held.size();
}

TEST(Memory, WorkOverTheLimitIsRefusedWithWhatItNeeds) {
  const std::uint64_t before = memory_limit();
  set_memory_limit(2000000);
  EXPECT_NO_THROW(check_memory(2000000, "fitting 5 x 4 cells", "dem.tif"));
  const std::string words = test::words_of<BadInput>([] { check_memory(3.5e9, "fitting 5 x 4 cells", "dem.tif"); });
  set_memory_limit(before);
  EXPECT_TRUE(test::holds(words, "fitting 5 x 4 cells needs about 3.50 GB of memory, and the limit is 2.00 MB"));
  EXPECT_NO_THROW(check_memory(3.5e9, "fitting", "")) << "a process that sets no limit has none";
}

TEST(Memory, SizesAreWrittenWithThreeDigits) {
  EXPECT_EQ(size_text(0), "0 bytes");
  EXPECT_EQ(size_text(999), "999 bytes");
  EXPECT_EQ(size_text(1000), "1.00 kB");
  EXPECT_EQ(size_text(1.5e6), "1.50 MB");
  EXPECT_EQ(size_text(64e6), "64.0 MB");
  EXPECT_EQ(size_text(999.9e6), "1.00 GB");
  EXPECT_EQ(size_text(640e9), "640 GB");
  EXPECT_EQ(size_text(5e15), "5000 TB");
}

}  // namespace
}  // namespace retalho
