// Tests that a robot whose model names nothing behaves like the same robot with names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <regex>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

// Two hinges and two slides; only the joints that others refer to must have names.
constexpr const char* kNamed = R"(
  <compiler angle="radian"/>
  <default><geom size="0.02" mass="0.2" contype="0" conaffinity="0"/></default>
  <worldbody><body name="foot">
    <geom name="g"/>
    <body name="turn"><joint name="j1" axis="0 0 1" range="-2 2"/><geom pos="0 0 0.1"/>
      <body name="elbow" pos="0 0 0.3"><joint name="j2" axis="0 1 0" range="-2 2"/><geom pos="0.1 0 0"/>
        <body name="hand" pos="0.3 0 0"><geom/>
          <body name="l" pos="0.1 0.05 0"><joint name="s1" type="slide" axis="0 1 0" range="-0.03 0"/><geom/></body>
          <body name="r" pos="0.1 -0.05 0"><joint name="s2" type="slide" axis="0 -1 0" range="-0.03 0"/><geom/></body>
        </body>
      </body>
    </body>
  </body></worldbody>
  <equality><joint joint1="s1" joint2="s2"/></equality>
  <actuator>
    <position name="a1" joint="j1" kp="90" kv="9"/><position name="a2" joint="j2" kp="80" kv="8"/>
    <position name="a3" joint="s1" kp="50" kv="5" ctrlrange="-0.03 0"/>
  </actuator>)";

// The names in it that nothing refers to.
constexpr const char* kNames = R"re( name="(a\d|l|r|g|turn)")re";

constexpr const char* kFields = R"(
root_body: foot
move_groups:
  arm: {kind: arm, joints: [j1, j2], leaf: {body: hand}}
  gripper: {kind: gripper, joints: [s1, s2], actuators: GRIP, leaf: {body: hand}FINGERS}
home: {arm: [0.2, 0.3]}
stiffness: 70
)";

std::string Replaced(std::string text, const char* from, const char* to) {
  return std::regex_replace(text, std::regex(from), to);
}

class UnnamedRobot : public ::testing::Test {
 protected:
  // Makes the robot of a model; `grip` is its gripper's actuator, `fingers` its configured fingers.
  Robot Make(const std::string& name, const std::string& xml, const char* grip,
             const char* fingers) {
    const std::string fields = Replaced(Replaced(kFields, "GRIP", grip), "FINGERS", fingers);
    const std::string file = folder_.Write(name, xml);
    const RobotConfig config =
        ParseYaml<RobotConfig>("name: " + name + "\nmodel: " + file + fields);
    const Scene scene = Scene::Build(
        SceneWith({.name = name,
                   .config = config,
                   .prefix = "p_",
                   .control_modes = std::vector{CtrlMode::kPosition, CtrlMode::kTorque}}));
    return Robot::Of(scene, name);
  }
  Robot Named() { return Make("named", kNamed, "a3", ", fingers: [{body: l}, {body: r}]"); }
  Robot Unnamed(const char* fingers = "") {
    return Make("unnamed", Replaced(kNamed, kNames, ""), "s1:actuator0", fingers);
  }
  static std::vector<double> Run(Robot robot) {
    robot.SetJntPosCmd(std::vector{0.5, -0.4});
    std::vector<double> seen;
    for (int i = 0; i < 40; ++i) {
      if (i == 20) robot.SetController("arm", "joint_torque");
      if (i == 30) robot.SetController("arm", "joint_position");
      robot.gripper().SetOpening(i < 20 ? 1 : 0.25);
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
      const mjData* d = robot.scene().data();
      seen.insert(seen.end(), d->qpos, d->qpos + robot.scene().model()->nq);
    }
    seen.push_back(robot.gripper().inter_finger_dist());
    seen.push_back(robot.gripper().inter_finger_dist_range().upper);
    return seen;
  }

  ModelFolder folder_;
};

TEST_F(UnnamedRobot, MovesLikeTheNamedOne) {
  const std::vector<double> named = Run(Named());
  EXPECT_EQ(Run(Unnamed()), named);
  EXPECT_EQ(Run(Unnamed(", fingers: [{body: {body: hand, index: 0}}, {body: {body: hand, index: "
                        "1}}]")),
            named);
  EXPECT_EQ(Run(Unnamed(", fingers: [{geom: {body: hand:body0, index: 0}}, {body: hand:body1}]")),
            named);
}

TEST_F(UnnamedRobot, ShowsLabels) {
  const Robot robot = Unnamed();
  EXPECT_THAT(robot.arm().actuator_names(), ElementsAre("p_j1:actuator0", "p_j2:actuator0"));
  EXPECT_EQ(robot.scene().model()->actuator_gainprm[0], 70) << "stiffness";
}

TEST_F(UnnamedRobot, IsFoundInABaseScene) {
  const std::string base = folder_.Write("base", Replaced(kNamed, kNames, ""));
  const Scene scene = Scene::Build(SceneSpec{.name = "test", .base = base, .timestep = 0.002});
  const Robot robot = Robot::FromScene(scene, "foot", "hand");
  EXPECT_THAT(robot.joint_names(), ElementsAre("j1", "j2"));
  EXPECT_THAT(robot.arm().actuator_names(), ElementsAre("j1:actuator0", "j2:actuator0"));
  EXPECT_EQ(robot.controller("arm").mode(), CtrlMode::kPosition);
}

}  // namespace
}  // namespace robocell
