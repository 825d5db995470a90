// The machine that runs this process.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace robocell::internal {

// Returns "" if the system does not report it.
std::string HostName();

// Returns when a process of this machine began, in the system's ticks; unset if there is no process
// of this number. Together with the number it identifies one process, and no later one with the
// same number.
std::optional<uint64_t> ProcessStart(int64_t process);

}  // namespace robocell::internal
