// The machine we run on.
#pragma once

#include <string>

namespace robocell {

// "" when the system does not say.
std::string HostName();

}  // namespace robocell
