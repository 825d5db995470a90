// For tests only: while one of these lives, what this thread allocates is no leak for
// LeakSanitizer. For calls into code of others that is known to lose memory in the case that is
// tested:
//
//   const LeaksOfOthers leaks;  // the engine forgets what it had made when it throws
//
// Without the sanitizer nothing.
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
