// Starts a program many times for little more than the cost of one start. Loading ffmpeg takes
// 0.08 s of a core, because it binds 43 000 symbols of 215 libraries. Here one process loads it,
// stops before its main function and waits; each start is a fork of that process and takes 0.006 s.
// All starts begin with the same memory, so that no start depends on an earlier one.
//
//   pid_t child = StartWarm({"/usr/bin/ffmpeg", "-i", "a.mp4", "b.mp4"}, {in, out, errors});
//   if (child < 0) child = ...;  // in the usual way
//
// The new process is a child of this one, in its own process group, with default signal handlers,
// the present working folder and descriptors 0, 1 and 2. After a change of the program's file, the
// environment, limits, processors, priority or user, another process is loaded. A waiting process
// that died is replaced, eight times in a row at most. It ends with this process, and after a minute
// without a start; it is reaped at the next start. A fork of this process has its own. Calls are
// safe on any thread.
//
// StartWarm refuses scripts, statically linked programs, programs of another C library and programs
// that have threads before their main function. ROBOCELL_WARM_FFMPEG=0 refuses all.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace robocell::internal {

struct ChildDescriptors {
  int in = -1, out = -1, errors = -1;
};

// Returns the child's process id, or -1 if the program has to be started in the usual way; then no
// process has touched the descriptors or the files. arguments[0] is the program's path.
pid_t StartWarm(const std::vector<std::string>& arguments, const ChildDescriptors& descriptors);

// Ends the process that waits, if there is one.
void EndWarmPrograms();
// Returns its process id, for tests and diagnosis; -1 if there is none.
pid_t WarmProgramPid();

}  // namespace robocell::internal
