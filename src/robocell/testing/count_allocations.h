// Counts heap allocations of C++ code on this thread (operator new), for tests of the hot path.
// Header only: include it in exactly one source of a test program, because it replaces the
// program's operator new.
//
//   const AllocationCount count;
//   ... hot path ...
//   EXPECT_EQ(count.allocations(), 0);
#pragma once

#include <cstdlib>
#include <new>

namespace robocell::allocation_internal {
inline thread_local long count = 0;
}

namespace robocell {

class AllocationCount {
 public:
  AllocationCount() : start_(allocation_internal::count) {}
  long allocations() const { return allocation_internal::count - start_; }

 private:
  long start_;
};

}  // namespace robocell

// Not inlined: g++ would see malloc and free in only one of a pair and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++robocell::allocation_internal::count;
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++robocell::allocation_internal::count;
  return std::malloc(size ? size : 1);
}
[[gnu::noinline]] void* operator new[](std::size_t size) { return operator new(size); }
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
