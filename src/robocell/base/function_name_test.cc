#include "robocell/base/function_name.h"

#include <gtest/gtest.h>

namespace robocell::internal {
namespace {

TEST(CppAndPythonName, FunctionsAreInSnakeCaseAndClassesStay) {
  EXPECT_EQ(CppAndPythonName("SetBodyPose"), "SetBodyPose (in Python set_body_pose)");
  EXPECT_EQ(CppAndPythonName("Freeze"), "Freeze (in Python freeze)");
  EXPECT_EQ(CppAndPythonName("Scene::Build"), "Scene::Build (in Python Scene.build)");
  EXPECT_EQ(CppAndPythonName("Robot::FromScene"), "Robot::FromScene (in Python Robot.from_scene)");
}

}  // namespace
}  // namespace robocell::internal
