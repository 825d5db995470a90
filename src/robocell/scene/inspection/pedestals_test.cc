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

TEST(Pedestals, WarnAboutARobotOffItsPedestal) {
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
  EXPECT_THAT(warnings(0.02, {}), ElementsAre(HasSubstr("Write `reset_root_pose: true`")));
  EXPECT_THAT(
      warnings(0, false),
      ElementsAre(HasSubstr("robot 'r': 'base' stands 0.319 m beside its pedestal, because of "
                            "the pose that the model's file gives it. Write "
                            "`reset_root_pose: true` in the robot file")));
}

// The root's frame is in the middle of its foot, and the file places it beside the origin.
TEST(Pedestals, SuggestAPoseEditWhereResetDoesNotHelp) {
  ModelFolder folder;
  RobotSpec robot = AsideOnAPedestal(folder, 0);
  robot.config->model = folder.Write("sunk", R"(<worldbody><frame pos="0 0 0.5">
    <body name="base" pos="-.469 .1 -.47"><geom type="cylinder" size=".07 .03"/>
      <body name="link" pos="0 0 .1"><joint name="j"/><geom size=".02" mass="1"/></body>
    </body></frame></worldbody>)");
  const auto warnings = [&] { return Scene::Build(WithRobot(robot)).compiled()->warnings(); };
  for (const bool reset : {true, false}) {
    robot.config->reset_root_pose = reset;
    EXPECT_THAT(warnings(), ElementsAre(HasSubstr("`reset_root_pose: false` and `edits: [{body: "
                                                  "'base', pos: [0.000, 0.000, 0.030]}]`")));
  }
  robot.config->edits = {{.body = ElementRef{.name = "base"}, .pos = Vec3{0, 0, 0.03}}};
  EXPECT_THAT(warnings(), IsEmpty()) << "the advice was followed";
  robot.config->edits.clear();
  robot.config->reset_root_pose.reset();
  EXPECT_THAT(warnings(), IsEmpty());
}

}  // namespace
}  // namespace robocell
