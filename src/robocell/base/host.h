// The machine we run on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace robocell::internal {

// "" when the system does not say.
std::string HostName();

// When a process of this machine began, in the system's ticks; unset when there is none of this
// number. With it the number names one process, and no later one that was given the same.
std::optional<uint64_t> ProcessStart(int64_t process);

}  // namespace robocell::internal
