// StopRequest: how long work is told to end early. It is asked now and then, on the thread that
// called for the work; once it has said true it goes on saying so. An exception that it throws ends
// the work too and comes out of it. Empty: nobody will ask to stop.
#pragma once

#include <functional>

namespace robocell {

using StopRequest = std::function<bool()>;

inline bool ShouldStop(const StopRequest& stop) { return stop && stop(); }

}  // namespace robocell
