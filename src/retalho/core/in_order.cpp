#include "retalho/core/in_order.h"

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <vector>

#include "retalho/core/arena.h"
#include "retalho/core/parallel.h"

namespace retalho {
namespace {

/// Work under way, one group a slot; what still runs when an exception passes is waited for.
class Slots {
 public:
  Slots(std::size_t count, tbb::task_arena& arena) : groups_(count), arena_(arena) {}
  Slots(const Slots&) = delete;
  Slots& operator=(const Slots&) = delete;
  ~Slots() {
    for (tbb::task_group& group : groups_) group.cancel();
    arena_.execute([&] {
      for (tbb::task_group& group : groups_) try {
          group.wait();
        } catch (...) {  // NOLINT(bugprone-empty-catch): another exception is on its way, or the work was not asked for
        }
    });
  }
  template <class Work>
  void start(std::size_t slot, Work&& work) {
    arena_.execute([&] { groups_[slot].run(std::forward<Work>(work)); });
  }
  void wait(std::size_t slot) {
    arena_.execute([&] { groups_[slot].wait(); });
  }

 private:
  std::vector<tbb::task_group> groups_;
  tbb::task_arena& arena_;
};

}  // namespace

std::size_t slot_count(const Context& context) {
  // Two a thread: one in the making and one that waits for its turn.
  const auto threads = static_cast<std::size_t>(thread_count(context));
  return threads == 1 ? 1 : 2 * threads;
}

void parallel_in_order(std::size_t count, const Context& context,
                       const std::function<void(std::size_t, std::size_t)>& make,
                       const std::function<void(std::size_t, std::size_t)>& take) {
  const std::size_t slots = std::min(slot_count(context), count);
  if (slots <= 1) {
    for (std::size_t i = 0; i < count; ++i) {
      context.check();
      make(i, 0);
      take(i, 0);
    }
    return;
  }
  Slots work(slots, arena_of(thread_count(context)));
  std::size_t started = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (; started < count && started < i + slots; ++started)
      work.start(started % slots, [&context, &make, started, slots] {
        context.check();
        make(started, started % slots);
      });
    work.wait(i % slots);
    take(i, i % slots);
  }
}

}  // namespace retalho
