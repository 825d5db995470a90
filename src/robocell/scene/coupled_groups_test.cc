#include "robocell/scene/coupled_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CoupledGroups : public ::testing::Test {
 protected:
  CoupledGroups() {
    RobotRecord& robot = robots.emplace_back();
    robot.name = "r";
    robot.prefix = "p_";
    MoveGroupConfig arm{.kind = MoveGroupKind::kArm};
    arm.joints.names = {"a", "b", "c"};
    robot.config.move_groups["arm"] = arm;
  }
  MoveGroupConfig& arm() { return robots[0].config.move_groups.at("arm"); }

  ModelPtr model = Compile(ParseXmlString(R"(<mujoco><compiler angle="radian"/><worldbody>
      <body><joint name="p_a"/><geom size=".1"/><body><joint name="p_b"/><geom size=".1"/>
      <body><joint name="p_c"/><geom size=".1"/></body></body></body></worldbody>
      <equality><joint joint1="p_b" joint2="p_a" polycoef="0 -1 0 0 0"/></equality></mujoco>)",
                                          "groups")
                               .get(),
                           nullptr, "groups");
  std::vector<RobotRecord> robots;
  CompileLog log;
};

TEST_F(CoupledGroups, LoseTheirFollowers) {
  robots[0].config.home["arm"] = {0.3, -0.3, 0.1};
  robots[0].config.home_noise["arm"] = {0.01, 0.02, 0.03};
  DropFollowers(model.get(), robots, log);
  EXPECT_THAT(arm().joints.names, ElementsAre("a", "c"));
  EXPECT_THAT(robots[0].config.home.at("arm"), ElementsAre(0.3, 0.1));
  EXPECT_THAT(robots[0].config.home_noise.at("arm"), ElementsAre(0.01, 0.03));
  EXPECT_THAT(log.notes(), ElementsAre(HasSubstr("arm 'arm': 'b' follows 'a'")));
  EXPECT_THAT(log.warnings(), IsEmpty());
}

TEST_F(CoupledGroups, WarnOfAHomeThatContradictsThem) {
  robots[0].config.home["arm"] = {0.3, 0.2, 0.1};
  DropFollowers(model.get(), robots, log);
  EXPECT_THAT(log.warnings(), ElementsAre(HasSubstr("'b' is 0.2, but it follows 'a' and begins at "
                                                    "-0.3")));
}

TEST_F(CoupledGroups, KeepWhatFollowsNothing) {
  arm().kind = MoveGroupKind::kGeneric;
  DropFollowers(model.get(), robots, log);
  EXPECT_THAT(arm().joints.names, ElementsAre("a", "b", "c"));
  EXPECT_THAT(log.notes(), IsEmpty());
}

TEST_F(CoupledGroups, OfAnyKindWarnOfAHomeThatContradictsThem) {
  arm().kind = MoveGroupKind::kGripper;
  robots[0].config.home["arm"] = {0.3, 0.2, 0.1};
  DropFollowers(model.get(), robots, log);
  EXPECT_THAT(log.warnings(), ElementsAre(HasSubstr("'b' is 0.2, but it follows 'a'")));
  EXPECT_THAT(robots[0].config.home.at("arm"), ElementsAre(0.3, 0.2, 0.1));
}

}  // namespace
}  // namespace robocell::internal
