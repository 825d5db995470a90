// Tests velocity mode of arms with resistance: dampers, springs, friction, motors instead of
// servos, limits.
#include "robocell/robot/joint_velocity_controller.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

// An arm that turns about the vertical, then about a level axis, so that gravity acts.
std::string Arm(const std::string& joint, const std::string& actuator) {
  return R"(
  <compiler angle="radian" autolimits="true"/>
  <default><joint armature="0.05" )" +
         joint + R"(/><geom type="capsule" contype="0" conaffinity="0" size="0.03"/></default>
  <worldbody>
    <body name="base">
      <geom mass="1" fromto="0 0 0 0 0 0.1"/>
      <body name="upper" pos="0 0 0.1">
        <joint name="j1" axis="0 0 1"/><geom mass="2" fromto="0 0 0 0.3 0 0"/>
        <body name="fore" pos="0.3 0 0">
          <joint name="j2" axis="0 1 0"/><geom mass="1" fromto="0 0 0 0.3 0 0"/>
          <site name="tcp" pos="0.3 0 0"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <)" + actuator +
         R"( name="a1" joint="j1"/><)" + actuator + R"( name="a2" joint="j2"/>
  </actuator>)";
}

class VelocityMode : public ::testing::Test {
 protected:
  Robot Build(const std::string& joint, const std::string& actuator, CtrlMode native) {
    RobotConfig config{.name = "arm", .model = folder.Write("arm", Arm(joint, actuator))};
    config.move_groups["arm"] = {.kind = MoveGroupKind::kArm,
                                 .joints = {"j1", "j2"},
                                 .actuators = {"a1", "a2"},
                                 .leaf = ElementRef{.kind = ElementKind::kSite, .name = "tcp"}};
    config.control["arm"] = ControlKind::kJointVelocity;
    RobotSpec spec{.name = "arm", .config = config};
    spec.control_modes = std::vector{native, kVelocity};
    SceneSpec scene = SceneWith(spec);
    scene.options = options;
    return Robot::Of(Scene::Build(scene), "arm");
  }

  static void Run(Robot& robot, const std::vector<double>& velocity, int steps) {
    robot.SetJntVelCmd(velocity);
    for (int i = 0; i < steps; ++i) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
    robot.Update();
  }

  static void ExpectReached(Robot& robot, const std::vector<double>& velocity) {
    Run(robot, velocity, 1000);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(robot.jnt_vel_msr()[i], velocity[i], 1e-3) << i;
  }

  ModelFolder folder;
  SimOptions options;
};

TEST_F(VelocityMode, ReachesTheVelocityAgainstDampersSpringsAndFriction) {
  for (const char* joint :
       {"damping='60'", "damping='2 10 30'", "frictionloss='5'",
        "stiffness='20 5 3' springref='0.4'", "damping='8' frictionloss='2' stiffness='10'"}) {
    SCOPED_TRACE(joint);
    Robot robot = Build(joint, "position kp='2000'", kPosition);
    ExpectReached(robot, {0.1, 0.1});
    ExpectReached(robot, {-0.1, 0});
  }
}

TEST_F(VelocityMode, TracksSlowVelocitiesAgainstFriction) {
  for (const char* joint : {"frictionloss='3'", "frictionloss='3' solreffriction='0.2 1'",
                            "frictionloss='3' solreffriction='-50 -20'",
                            "frictionloss='3' solimpfriction='0.3 0.8 0.01'"}) {
    SCOPED_TRACE(joint);
    for (const double speed : {1e-6, -1e-3, 0.02}) {
      Robot robot = Build(joint, "position kp='400' kv='20'", kPosition);
      Run(robot, {0, speed}, 1500);
      EXPECT_NEAR(robot.jnt_vel_msr()[1], speed, 0.1 * std::abs(speed)) << speed;
    }
  }
}

TEST_F(VelocityMode, MotorsReachTheVelocityWhileOtherJointsRest) {
  Robot robot = Build("damping='0.4'", "motor ctrlrange='-90 90'", kTorque);
  ExpectReached(robot, {0.1, 0.1});
  ExpectReached(robot, {0, 0});
  const double before = robot.jnt_pos_msr()[1];
  ExpectReached(robot, {0.3, 0});
  EXPECT_NEAR(robot.jnt_pos_msr()[1], before, 1e-3);
}

TEST_F(VelocityMode, OvercomesDampersOfDisabledActuators) {
  Robot robot = Build("damping='1'", "position kp='500' damping='12' gear='2'", kPosition);
  ExpectReached(robot, {0.1, -0.1});
}

TEST_F(VelocityMode, MotorsRespectTheirControlRange) {
  Robot robot = Build("damping='0.4'", "motor ctrlrange='-3 6' gear='2'", kTorque);
  robot.SetJntVelCmd(std::vector<double>{50, -50});
  for (int i = 0; i < 20; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
    robot.Update();
    EXPECT_LE(robot.jnt_trq_msr()[0], 12) << i;
    EXPECT_GE(robot.jnt_trq_msr()[1], -6) << i;
    EXPECT_NEAR(robot.jnt_trq_msr()[0], 12, 0.02) << i;
    EXPECT_NEAR(robot.jnt_trq_msr()[1], -6, 0.02) << i;
  }
}

// Otherwise joints without resistance would be pushed.
TEST_F(VelocityMode, ReachesTheVelocityWithDisabledPassiveForces) {
  options.disable = {"spring", "damper", "frictionloss"};
  for (const char* joint :
       {"damping='60'", "frictionloss='5'", "stiffness='20 5 3' springref='0.4'"}) {
    SCOPED_TRACE(joint);
    Robot robot = Build(joint, "position kp='2000'", kPosition);
    ExpectReached(robot, {0.1, 0.1});
    ExpectReached(robot, {-0.1, 0});
  }
}

}  // namespace
}  // namespace robocell::internal
