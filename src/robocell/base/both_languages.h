// Functions in messages, which C++ and Python share: one rule for how they are written.
#pragma once

#include <string>
#include <string_view>

namespace robocell {

// A function by the names that it has in C++ and in Python: "SetBodyPose" becomes "SetBodyPose (in
// Python set_body_pose)", "Scene::Build" becomes "Scene::Build (in Python Scene.build)".
std::string InBothLanguages(std::string_view function);

}  // namespace robocell
