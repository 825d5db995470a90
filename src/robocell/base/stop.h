// StopRequest: asks long work to end early. The work calls it occasionally, on its caller's thread;
// once it has returned true it keeps returning true. Its exception ends the work too and is
// rethrown. Empty: no stop request.
#pragma once

#include <functional>

namespace robocell {

using StopRequest = std::function<bool()>;

inline bool ShouldStop(const StopRequest& stop) { return stop && stop(); }

}  // namespace robocell
