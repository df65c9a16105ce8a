// Chunks are fixed by the grain alone; every index is visited once; exceptions and cancelling reach the caller.
#include "retalho/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace retalho {
namespace {

TEST(Parallel, VisitsEveryIndexOnceFromAnyNumberOfThreads) {
  for (const int threads : {1, 2, 3, 7}) {
    Context context;
    context.threads = threads;
    std::vector<int> visits(1003, 0);
    parallel_chunks(visits.size(), 10, context, [&](std::size_t begin, std::size_t end) {
      EXPECT_EQ(begin % 10, 0U);
      EXPECT_TRUE(end == begin + 10 || end == visits.size());
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    EXPECT_EQ(visits, std::vector<int>(1003, 1));
  }
}

TEST(Parallel, ManySmallLoopsAreCheap) {
  Context context;
  context.threads = 3;
  std::atomic<int> sum = 0;
  for (int i = 0; i < 20000; ++i)
    parallel_chunks(4, 1, context, [&](std::size_t b, std::size_t) { sum += static_cast<int>(b); });
  EXPECT_EQ(sum, 20000 * 6);
}

TEST(Parallel, RethrowsAndStops) {
  Context context;
  context.threads = 2;
  EXPECT_THROW(parallel_chunks(100, 1, context,
                               [](std::size_t b, std::size_t) {
                                 if (b == 50) throw BadInput("fifty");
                               }),
               BadInput);
  std::atomic<bool> cancel = true;
  context.cancel = &cancel;
  EXPECT_THROW(parallel_chunks(100, 1, context, [](std::size_t, std::size_t) {}), Interrupted);
}

}  // namespace
}  // namespace retalho
