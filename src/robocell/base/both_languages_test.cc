#include "robocell/base/both_languages.h"

#include <gtest/gtest.h>

namespace robocell {
namespace {

TEST(InBothLanguages, FunctionsAreInSnakeCaseAndClassesStay) {
  EXPECT_EQ(InBothLanguages("SetBodyPose"), "SetBodyPose (in Python set_body_pose)");
  EXPECT_EQ(InBothLanguages("Freeze"), "Freeze (in Python freeze)");
  EXPECT_EQ(InBothLanguages("Scene::Build"), "Scene::Build (in Python Scene.build)");
  EXPECT_EQ(InBothLanguages("Robot::FromScene"), "Robot::FromScene (in Python Robot.from_scene)");
}

}  // namespace
}  // namespace robocell
