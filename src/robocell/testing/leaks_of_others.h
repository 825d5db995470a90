// For tests only: during its lifetime LeakSanitizer ignores allocations of this thread. For calls
// into other libraries that are known to leak memory in the tested case:
//
//   const LeaksOfOthers leaks;  // the engine forgets what it had made when it throws
//
// Without the sanitizer it does nothing.
#pragma once

// NOLINTBEGIN(clang-diagnostic-reserved-identifier): the sanitizer's names
extern "C" __attribute__((weak)) void __lsan_disable();
extern "C" __attribute__((weak)) void __lsan_enable();
// NOLINTEND(clang-diagnostic-reserved-identifier)

namespace robocell {

class LeaksOfOthers {
 public:
  LeaksOfOthers() {
    if (__lsan_disable) __lsan_disable();
  }
  ~LeaksOfOthers() {
    if (__lsan_enable) __lsan_enable();
  }
  LeaksOfOthers(const LeaksOfOthers&) = delete;
  LeaksOfOthers& operator=(const LeaksOfOthers&) = delete;
};

}  // namespace robocell
