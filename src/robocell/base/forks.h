// Tells a process from its forks without a system call.
#pragma once

namespace robocell::internal {

// Returns a number that differs between a process and each of its forks since the first call.
int ForkCount();

}  // namespace robocell::internal
