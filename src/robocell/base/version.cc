#include "robocell/base/version.h"

#ifndef ROBOCELL_VERSION
#error "the build defines ROBOCELL_VERSION for this file"
#endif

namespace robocell {

std::string_view Version() { return ROBOCELL_VERSION; }

}  // namespace robocell
