// The largest number of joints of a chain. It has a separate header, because kernels for other
// instruction sets include no more than they must.
#pragma once

namespace robocell {

// Longest supported chain; making a longer one throws ArgumentError.
inline constexpr int kMaxChainJoints = 16;

}  // namespace robocell
