// Runs a test on every instruction set for which there is code and which this processor has.
#pragma once

#include <functional>
#include <string>

namespace robocell {

// Calls `test` with the name of the instruction set that all kernels use meanwhile.
void OnEveryInstructionSet(const std::function<void(const std::string& name)>& test);

}  // namespace robocell
