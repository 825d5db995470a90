// Runs a test on every instruction set that has code and that this processor supports.
#pragma once

#include <functional>
#include <string>

namespace robocell {

// Calls `test` with the name of the instruction set that all kernels use during the call.
void OnEveryInstructionSet(const std::function<void(const std::string& name)>& test);

}  // namespace robocell
