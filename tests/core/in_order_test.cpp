// Each result is taken once, in order, in the calling thread; exceptions and cancelling reach the caller.
#include "retalho/core/in_order.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <thread>
#include <vector>

namespace retalho {
namespace {

TEST(InOrder, TakesEachResultOnceInOrderInTheCallingThread) {
  for (const int threads : {1, 2, 3, 7}) {
    Context context;
    context.threads = threads;
    std::vector<std::size_t> slots(slot_count(context), 0), taken;
    const auto caller = std::this_thread::get_id();
    parallel_in_order(
        500, context,
        [&](std::size_t i, std::size_t slot) {
          ASSERT_LT(slot, slots.size());
          EXPECT_EQ(slots[slot], 0U);  // what was there has been taken
          slots[slot] = i + 1;
        },
        [&](std::size_t i, std::size_t slot) {
          EXPECT_EQ(std::this_thread::get_id(), caller);
          EXPECT_EQ(slots[slot], i + 1);
          slots[slot] = 0;
          taken.push_back(i);
        });
    std::vector<std::size_t> all(500);
    std::iota(all.begin(), all.end(), std::size_t{0});
    EXPECT_EQ(taken, all);
  }
}

TEST(InOrder, RethrowsWhatEitherThrowsAndStops) {
  for (const int threads : {1, 2, 5}) {
    Context context;
    context.threads = threads;
    std::atomic<int> running = 0;
    const auto make = [&](std::size_t i, std::size_t) {
      ++running;
      if (i == 50) {
        --running;
        throw BadInput("fifty");
      }
      --running;
    };
    std::size_t last = 0;
    EXPECT_THROW(parallel_in_order(100, context, make, [&](std::size_t i, std::size_t) { last = i; }), BadInput);
    EXPECT_EQ(last, 49U);
    EXPECT_EQ(running, 0);  // nothing goes on behind the caller's back
    EXPECT_THROW(parallel_in_order(40, context, make,
                                   [&](std::size_t i, std::size_t) {
                                     if (i == 7) throw CannotWrite("seven");
                                   }),
                 CannotWrite);
    EXPECT_EQ(running, 0);
    std::atomic<bool> cancel = true;
    context.cancel = &cancel;
    EXPECT_THROW(parallel_in_order(100, context, make, [](std::size_t, std::size_t) {}), Interrupted);
  }
}

}  // namespace
}  // namespace retalho
