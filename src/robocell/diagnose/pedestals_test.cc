// Tests robots that do not stand on their pedestal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "robocell/scene/scene.h"
#include "robocell/scene/testing/pedestal.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Pedestals, WarnsOfARobotThatStandsBesideAboveOrInItsPedestal) {
  ModelFolder folder;
  const auto warnings = [&](double height, std::optional<bool> reset) {
    RobotSpec robot = AsideOnAPedestal(folder, height);
    robot.config->reset_root_pose = reset;
    return Scene::Build(WithRobot(robot)).compiled()->warnings();
  };
  EXPECT_THAT(warnings(0, {}), IsEmpty());
  EXPECT_THAT(warnings(0.02, true), IsEmpty());
  EXPECT_THAT(warnings(0.02, {}), ElementsAre(HasSubstr("'base' is 0.020 m above its pedestal")));
  EXPECT_THAT(warnings(-0.03, {}),
              ElementsAre(HasSubstr("'base' stands 0.030 m deep in its pedestal")));
  EXPECT_THAT(
      warnings(0, false),
      ElementsAre(HasSubstr("robot 'r': 'base' stands 0.319 m beside its pedestal, because of "
                            "the pose that the model's file gives it. Write "
                            "`reset_root_pose: true` in the robot file")));
}

}  // namespace
}  // namespace robocell
