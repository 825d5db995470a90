#include "robocell/motion/gripper_shape.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/mujoco/names.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

TEST(GripperShape, FindsTheAxesOfTheGraspInTheTcpFrame) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const Eigen::Matrix3d axes = pick.shape()->grasp_in_tcp().rotation();
  EXPECT_NEAR(axes(2, 2), 1, 1e-12);            // rc7 approaches along z of its TCP
  EXPECT_NEAR(std::abs(axes(1, 1)), 1, 1e-12);  // and closes along y
}

// The oracle is the finger distance of another scene with the shape's joints.
TEST(GripperShape, TheJointsOfAGapProduceThatGap) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const auto shape = pick.shape();
  std::vector<double> joints(shape->joint_names().size());
  for (const double gap : {0.01, 0.03, 0.0505, 0.08}) {
    shape->JointsAt(gap, joints);
    for (size_t i = 0; i < joints.size(); ++i) {
      const int j = FindId(pick.scene.model(), mjOBJ_JOINT, "robot_0/" + shape->joint_names()[i]);
      pick.scene.data()->qpos[pick.scene.model()->jnt_qposadr[j]] = joints[i];
    }
    Scene(pick.scene).Forward();
    EXPECT_NEAR(pick.robot.gripper().inter_finger_dist(), gap, 3e-4);
  }
}

// The gripper's file is edited during the process.
TEST(GripperShape, FollowsTheModelsFile) {
  TempDir temp;
  RobotConfig config = LoadYaml<RobotConfig>(assets::BuiltinRobotFile("rc7"));
  std::filesystem::copy(config.source_dir, temp.path(), std::filesystem::copy_options::recursive);
  config.source_dir = temp.path().string();
  const auto before = GripperShape::Of(config, {}, 0.002);
  EXPECT_EQ(GripperShape::Of(config, {}, 0.002), before) << "measured once";
  std::string text = ReadFile(temp / "rc7.xml");
  const std::string range = R"(range="0 0.044")";
  ASSERT_NE(text.find(range), std::string::npos);
  text.replace(text.find(range), range.size(), R"(range="0 0.050")");
  AtomicWrite(temp / "rc7.xml", text);
  EXPECT_NE(GripperShape::Of(config, {}, 0.002), before);
}

TEST(GripperShape, SpansTheConfiguredRangeAndClampsOutsideOfIt) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const auto shape = pick.shape();
  const Interval range = pick.robot.gripper().inter_finger_dist_range();
  EXPECT_NEAR(shape->closed_gap(), range.lower, 1e-3);
  EXPECT_NEAR(shape->open_gap(), range.upper, 1e-3);
  EXPECT_EQ(shape->PadAt(-1), shape->rows().front().pad);
  EXPECT_EQ(shape->PadAt(1), shape->rows().back().pad);
  EXPECT_EQ(shape->TipAt(1), shape->rows().back().tip);
}

// By design rc7's pads meet at the TCP, are 24 mm high and 22 mm wide, and end 12 mm beyond.
TEST(GripperShape, FindsThePadsOfTheBuiltInArm) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const auto shape = pick.shape();
  EXPECT_LT(shape->PadAt(0.04).norm(), 1e-4);
  EXPECT_NEAR(shape->pad_half_height(), 0.012, 1e-4);
  EXPECT_NEAR(shape->pad_half_width(), 0.011, 1e-4);
  EXPECT_NEAR(shape->TipAt(0.04), 0.0122, 2e-4);
}

TEST(GripperShape, IsMadeOnceForEqualConfigurations) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  EXPECT_EQ(pick.shape(), pick.shape());
  RobotConfig other = pick.robot.config();
  other.gravcomp = false;
  EXPECT_NE(pick.shape(), GripperShape::Of(other, pick.run.options, 0.002));
}

// The linkage swings the pads forward while it closes; the tips then reach lower than the open
// ones.
TEST(GripperShape, FollowsTheSwingOfALinkage) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"), "xarm7_pick.yaml");
  const auto shape = pick.shape();
  EXPECT_NEAR(shape->PadAt(shape->open_gap()).z(), -0.0208, 1e-3);
  EXPECT_NEAR(shape->PadAt(0.04).z(), -0.0093, 1e-3);
  EXPECT_NEAR(shape->TipAt(0.088), -0.0098, 2e-3);
  EXPECT_NEAR(shape->TipAt(0), 0.003, 2e-3);
}

// One jaw is fixed, the other turns about a hinge 80 mm behind the tips by up to 1.6 rad: the
// direction from finger to finger turns with it, but the closing direction is an axis of the TCP.
TEST(GripperShape, AJawOnAHingeClosesAlongAnAxisOfTheTcp) {
  constexpr const char* kJaws = R"(<mujoco><compiler angle="radian"/><worldbody><body name="base">
    <body name="link"><joint name="j1" axis="0 0 1" range="-2 2" limited="true"/>
      <geom size=".02" mass="1" contype="0" conaffinity="0"/>
    <body name="palm"><joint name="j2" axis="0 1 0" range="-2 2" limited="true"/>
      <geom size=".01" mass=".1" contype="0" conaffinity="0"/>
      <site name="tcp" pos="0 0 .08"/>
      <geom name="fixed" type="box" size=".008 .001 .01" pos="0 -.001 .08" mass=".01"/>
      <body name="jaw" pos="0 .01 0"><joint name="jaw" axis="-1 0 0" range="0 1.6" limited="true"
        damping=".1"/>
        <geom name="moving" type="box" size=".008 .001 .01" pos="0 -.008 .08" mass=".01"/>
      </body></body></body></body></worldbody><actuator>
    <position name="s1" joint="j1" kp="100" kv="10"/><position name="s2" joint="j2" kp="100" kv="10"/>
    <position name="grip" joint="jaw" kp="2" kv=".1" ctrlrange="0 1.6"/></actuator></mujoco>)";
  TempDir folder;
  AtomicWrite(folder / "jaws.xml", kJaws);
  RobotConfig config;
  config.name = "jaws";
  config.model = (folder / "jaws.xml").string();
  config.move_groups["arm"] = {
      .kind = MoveGroupKind::kArm, .joints = {"j1", "j2"}, .actuators = {"s1", "s2"}};
  config.move_groups["arm"].leaf = ElementRef{.name = "tcp"};
  config.move_groups["gripper"] = {.kind = MoveGroupKind::kGripper,
                                   .joints = {"jaw"},
                                   .actuators = {"grip"},
                                   .fingers = {{.name = "fixed"}, {.name = "moving"}}};
  const auto shape = GripperShape::Of(config, {}, 0.002);
  const Eigen::Matrix3d axes = shape->grasp_in_tcp().rotation();
  EXPECT_NEAR(axes(2, 2), 1, 1e-12) << "approach along z of the TCP";
  EXPECT_NEAR(std::abs(axes(1, 1)), 1, 1e-12) << "closes along y";
  EXPECT_GT(shape->open_gap(), 0.08);
  EXPECT_LT(shape->closed_gap(), 0.002);
  EXPECT_NEAR(shape->PadAt(0.0).z(), 0, 3e-3);
  EXPECT_LT(shape->PadAt(shape->open_gap()).z(), -0.02) << "the open jaw swings back";
}

TEST(GripperShape, NamesARobotWithoutAGripper) {
  RobotConfig config = ExampleRun("demo.yaml").robot.config;
  const MoveGroupConfig arm = config.move_groups.at("arm");
  config.move_groups = {{"arm", arm}};
  config.home.clear();
  config.home_noise.clear();
  config.control.clear();
  try {
    GripperShape::Of(config, {}, 0.002);
    FAIL();
  } catch (const NotFoundError& error) {
    EXPECT_NE(std::string(error.what()).find("robot 'rc7': has no gripper group"),
              std::string::npos)
        << error.what();
  }
}

TEST(GripperShape, RejectsAnUnstableGripper) {
  RunConfig run = ExampleRun("demo.yaml");
  run.options.integrator = Integrator::kRk4;  // explicit: a stiff servo needs short steps
  Edit stiff;
  stiff.actuator = ElementRef{.name = "gripper"};
  stiff.kp = 1e9;
  run.robot.config.edits.push_back(stiff);
  ExpectThrow<DivergedError>(
      [&] { GripperShape::Of(run.robot.config, run.options, 0.1); },
      "robot 'rc7': its gripper is unstable at a timestep of 0.1 s: moving it to opening");
}

}  // namespace
}  // namespace robocell
