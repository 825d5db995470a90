// The other way round than Resolve: the name of a model file that means the same on every machine.
//
//   PortableName("<menagerie>/ufactory_xarm7/xarm7.xml")   // menagerie:ufactory_xarm7/xarm7.xml
//   PortableName("<models>/robots/rc7/rc7.xml") // rc7
//   PortableName("mine/arm.xml")                              // unset: only this machine has it
#pragma once

#include <optional>
#include <string>

namespace robocell::assets {

// Returns the name of a built-in or Menagerie model that Resolve maps to exactly this file.
std::optional<std::string> PortableName(const std::string& path);

}  // namespace robocell::assets
