// The name of a function in messages that C++ and Python share.
#pragma once

#include <string>
#include <string_view>

namespace robocell::internal {

// Returns the function's name in both languages: "SetBodyPose (in Python set_body_pose)" for
// "SetBodyPose", "Scene::Build (in Python Scene.build)" for "Scene::Build".
std::string CppAndPythonName(std::string_view function);

}  // namespace robocell::internal
