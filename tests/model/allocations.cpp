// Every `new` of this program goes by here. In a file of its own, so that no compiler sees through it.
#include "allocations.h"

#include <cstdlib>
#include <new>

namespace retalho::test {
std::size_t largest_allocation = 0;
}

void* operator new(std::size_t size) {
  if (size > retalho::test::largest_allocation) retalho::test::largest_allocation = size;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
