// Tests the bases: which can be moved, how, and the errors of the others.
#include "robocell/robot/base_group.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/source_dir.h"

namespace robocell::internal {
namespace {

Robot OnBase(const BaseConfig& base, const Vec3& pos = {}, const Vec3& euler = {}) {
  RobotConfig config = Rc7();
  config.base = base;
  const Scene scene = Scene::Build(
      SceneWith({.name = "rc7", .config = config, .prefix = "r_", .pos = pos, .euler = euler}));
  return Robot::Of(scene, "rc7");
}

TEST(MocapBase, TeleportsAndStaysWhileTheArmMoves) {
  Robot robot = OnBase({.kind = BaseKind::kMocap, .size = Vec3{0.2, 0.2, 0.3}}, {1, 0, 0});
  BaseGroup& base = robot.base();
  EXPECT_FALSE(base.is_mobile());
  EXPECT_EQ(base.nq(), 0);
  EXPECT_TRUE(base.pose().is_close(Pose(Eigen::Vector3d(1, 0, 0)), 1e-12, 1e-12));
  EXPECT_NEAR(robot.base_in_world().translation().z(), 0.3, 1e-12) << "on the pedestal";
  const Pose placed = Pose::FromRpy({0.5, 0.5, 0.1}, {0, 0.2, 1});
  base.SetPose(placed);
  robot.Apply({{"arm", GroupCommand::RelativeJoints({1, 0, 0, 0, 0, 0, 0})}});
  for (int i = 0; i < 200; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_EQ(base.pose(), placed);
}

TEST(FixedBase, RejectsMotionAndSuggestsAnotherKind) {
  for (const auto& size : {std::optional<Vec3>(), std::optional<Vec3>({0.2, 0.2, 0.3})}) {
    Robot robot = OnBase({.kind = BaseKind::kFixed, .size = size}, {0, 1, 0}, {0, 0, 90});
    EXPECT_TRUE(
        robot.base().pose().is_close(Pose::FromRpy({0, 1, 0}, {0, 0, M_PI / 2}), 1e-9, 1e-9));
    EXPECT_FALSE(robot.base().is_mobile());
    ExpectThrow<ArgumentError>([&] { robot.base().SetPose(Pose()); },
                               "robot 'rc7' / group 'base': a fixed base cannot be moved; give the "
                               "robot `base: {kind: mocap}` to place it");
  }
}

TEST(FreeBase, CanBePlacedAndFallsFromThere) {
  Robot robot = OnBase({.kind = BaseKind::kFree, .size = Vec3{0.2, 0.2, 0.1}});
  BaseGroup& base = robot.base();
  EXPECT_TRUE(base.is_mobile());
  EXPECT_EQ(base.nq(), 7);
  EXPECT_EQ(base.nv(), 6);
  const Pose mount = base.pose().inverse() * robot.base_in_world();
  const Pose placed = Pose::FromRpy({0.3, -0.2, 5}, {0.5, 0.1, 2});
  base.SetPose(placed);
  EXPECT_TRUE(base.pose().is_close(placed, 1e-12, 1e-12));
  EXPECT_TRUE(robot.base_in_world().is_close(placed * mount, 1e-12, 1e-12));
  EXPECT_EQ(base.joint_vel(), std::vector<double>(6, 0.0));
  for (int i = 0; i < 50; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  EXPECT_LT(base.pose().translation().z(), 5);
}

TEST(PlanarBase, MovesInItsPlaneOnly) {
  Robot robot =
      OnBase({.kind = BaseKind::kPlanar, .size = Vec3{0.4, 0.4, 0.3}}, {1, 2, 0.5}, {0, 0, 30});
  BaseGroup& base = robot.base();
  EXPECT_TRUE(base.is_mobile());
  EXPECT_EQ(base.joint_names(), (std::vector<std::string>{"r_base_x", "r_base_y", "r_base_yaw"}));
  const Pose mount = base.pose().inverse() * robot.base_in_world();
  for (const double yaw : {0.4, -2.9, 3.1}) {
    const Pose placed = Pose::FromRpy({-1, 0.7, 0.5}, {0, 0, yaw});
    base.SetPose(placed);
    EXPECT_TRUE(base.pose().is_close(placed, 1e-9, 1e-9));
    EXPECT_TRUE(robot.base_in_world().is_close(placed * mount, 1e-9, 1e-9));
  }
  const Pose before = base.pose();
  ExpectThrow<ArgumentError>(
      [&] {
        base.SetPose(Pose::FromRpy({0, 0, 0.7}, {0.1, 0, 0}));
      },
      "group 'base': a planar base moves in its plane only; the pose is 0.2 m above it and tilted "
      "by 0.1 rad");
  EXPECT_EQ(base.pose(), before);
}

// A model with joints and actuators of its own for a planar base gets no others.
TEST(PlanarBase, MovesByTheModelsOwnJointsAndTheirActuatorsHoldIt) {
  const RobotConfig config =
      RobotConfig::Load(SourceDir() + "/models/robots/rc7_mobile/rc7_mobile.yaml");
  const Scene scene = Scene::Build(SceneWith({.name = "m",
                                              .config = config,
                                              .prefix = "r_",
                                              .pos = Vec3{1, 2, 0.5},
                                              .euler = {0, 0, 30}}));
  Robot robot = Robot::Of(scene, "m");
  BaseGroup& base = robot.base();
  EXPECT_EQ(base.joint_names(), (std::vector<std::string>{"r_base_x", "r_base_y", "r_base_yaw"}));
  EXPECT_EQ(base.actuator_names().size(), 3U);
  EXPECT_EQ(scene.model()->nq, 3 + 7 + 2);
  const Pose placed = Pose::FromRpy({-1, 0.7, 0.5}, {0, 0, 2.5});
  base.SetPose(placed);
  EXPECT_TRUE(base.pose().is_close(placed, 1e-9, 1e-9));
  std::vector<double> q = base.joint_pos();
  q[0] += 0.1;
  for (int i = 0; i < 750; ++i) {
    if (i % 33 == 0) robot.Apply({{"base", GroupCommand::Joints(q)}});
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_NEAR(base.joint_pos()[0], q[0], 2e-3);
  EXPECT_NEAR((base.pose().translation() - placed.translation()).norm(), 0.1, 2e-3);
}

// A hinge may turn about a point beside the base's origin, and joint values may begin elsewhere than at 0.
TEST(PlanarBase, IsPutWhereItIsToldWhateverTheZeroAndThePivotOfItsJoints) {
  ModelFolder folder;
  const std::string cart = folder.Write("cart", R"(
    <compiler angle="radian" autolimits="true"/>
    <worldbody><body name="cart" pos="0.1 0.2 0.3" euler="0 0 0.5">
      <joint name="x" type="slide" axis="1 0 0" ref="0.4" range="-5 5"/>
      <joint name="y" type="slide" axis="0 1 0"/>
      <joint name="yaw" axis="0 0 1" pos="0.3 -0.2 0" ref="-0.7"/>
      <geom type="box" size=".2 .1 .1"/>
    </body></worldbody>)");
  RobotConfig config{
      .name = "cart", .model = cart, .root_body = "cart", .base = {.kind = BaseKind::kPlanar}};
  config.move_groups["wheels"] = {.kind = MoveGroupKind::kBase};
  Robot robot = RobotAlone(config);
  BaseGroup& base = robot.base();
  ASSERT_EQ(base.joint_names(), (std::vector<std::string>{"x", "y", "yaw"}));
  Rng rng = Rng::Stream(7, "cart");
  for (int i = 0; i < 20; ++i) {
    const Pose placed =
        Pose::FromRpy({rng.Uniform(-2, 2), rng.Uniform(-2, 2), base.pose().translation().z()},
                      {0, 0, rng.Uniform(-3, 3)});
    base.SetPose(placed);
    EXPECT_TRUE(base.pose().is_close(placed, 1e-9, 1e-9)) << i;
  }
  const Pose before = base.pose();
  ExpectThrow<ArgumentError>(
      [&] { base.SetPose(Pose(Eigen::Vector3d(9, 0, before.translation().z()))); },
      "group 'wheels': for this pose joint 'x' would be at ");
  EXPECT_EQ(base.pose(), before);
}

// Joints in any order: slides after the hinge move along turned axes.
TEST(PlanarBase, MayHaveItsJointsInAnyOrderAndAlongAnyLevelAxes) {
  const std::string x = R"(<joint name="x" type="slide" axis="-1 0 0"/>)",
                    y = R"(<joint name="y" type="slide" axis="0.6 0.8 0"/>)",
                    yaw = R"(<joint name="yaw" axis="0 0 -1" pos="0.1 0.2 0" ref="0.3"/>)";
  for (const std::string& joints : {x + y + yaw, yaw + y + x, y + yaw + x}) {
    ModelFolder folder;
    RobotConfig config{.name = "cart",
                       .model = folder.Write("cart",
                                             "<compiler angle=\"radian\"/><worldbody><body "
                                             "name=\"cart\">" +
                                                 joints +
                                                 "<geom type=\"box\" size=\".2 .1 .1\"/>"
                                                 "</body></worldbody>"),
                       .root_body = "cart",
                       .base = {.kind = BaseKind::kPlanar}};
    config.move_groups["wheels"] = {.kind = MoveGroupKind::kBase, .joints = {"yaw", "x", "y"}};
    Robot robot = RobotAlone(config);
    BaseGroup& base = robot.base();
    ASSERT_EQ(robot.scene().model()->nq, 3) << joints;
    Rng rng = Rng::Stream(8, "order");
    for (int i = 0; i < 10; ++i) {
      const Pose placed =
          Pose::FromRpy({rng.Uniform(-2, 2), rng.Uniform(-2, 2), base.pose().translation().z()},
                        {0, 0, rng.Uniform(-3, 3)});
      base.SetPose(placed);
      EXPECT_TRUE(base.pose().is_close(placed, 1e-9, 1e-9)) << joints;
    }
  }
}

TEST(AnyMovableBase, IsAtRestAfterPlacement) {
  for (const BaseKind kind : {BaseKind::kPlanar, BaseKind::kFree}) {
    Robot robot = OnBase({.kind = kind, .size = Vec3{0.4, 0.4, 0.3}});
    BaseGroup& base = robot.base();
    base.SetJointVel(std::vector<double>(base.nv(), 0.5));
    Pose aside = base.pose();
    aside = Pose(Eigen::Vector3d(1, 0, 0)) * aside;
    base.SetPose(aside);
    EXPECT_EQ(base.joint_vel(), std::vector<double>(base.nv(), 0.0)) << ToString(kind);
    EXPECT_TRUE(base.pose().is_close(aside, 1e-9, 1e-9)) << ToString(kind);
  }
}

TEST(PlanarBase, NeedsThreeJointsIfConfigured) {
  RobotConfig config = Rc7();
  config.base = {.kind = BaseKind::kPlanar};
  config.move_groups["wheels"] = {.kind = MoveGroupKind::kBase, .joints = {"base_x", "base_y"}};
  ExpectThrow<ArgumentError>([&] { RobotAlone(config); },
                             "group 'wheels': a planar base has the joints x, y and yaw, this one "
                             "has 2 joint values");
}

TEST(ConfiguredBase, UsesTheGeneratedBaseBody) {
  RobotConfig config = Rc7();
  config.move_groups["stand"] = {.kind = MoveGroupKind::kBase};
  Robot robot = RobotAlone(config);
  EXPECT_EQ(&robot.base(), &robot.group("stand"));
  EXPECT_FALSE(robot.has_group("base"));
  robot.base().SetPose(Pose(Eigen::Vector3d(0, 0, 1)));
  EXPECT_NEAR(robot.base_in_world().translation().z(), 1.25, 1e-12);
}

}  // namespace
}  // namespace robocell::internal
