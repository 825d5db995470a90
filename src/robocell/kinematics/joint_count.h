// How many joints a chain may have. On its own, as kernels for other instruction sets include no
// more than they must.
#pragma once

namespace robocell {

// Longest chain that robocell handles; a longer one is an ArgumentError when the chain is made.
inline constexpr int kMaxChainJoints = 16;

}  // namespace robocell
