// Tests bases on wheels: random carts drive to random places, on whatever servos, wheels and axle.
#include "robocell/robot/wheeled_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>
#include <fmt/format.h>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/robot/planar_motion.h"
#include "robocell/robot/robot.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

// A cart with two driven wheels and a castor at both ends.
struct Cart {
  double radius = 0.1, half_track = 0.2;
  double heading = 0;              // of the wheels, rad from the root's x axis
  double axle = 0;                 // m ahead of the root's origin
  double origin_height = 0;        // of the root's origin above the floor
  std::string servo = "velocity";  // or motor, position, tendons
  bool is_mirrored = false;        // the right wheel turns about -y

  std::string Wheel(const std::string& name, double side) const {
    return fmt::format(
        "<body name=\"{0}\" pos=\"{1} {2} {3}\"><joint name=\"{0}\" axis=\"0 {4} 0\" "
        "damping=\"0.05\" armature=\"0.01\"/><geom type=\"cylinder\" size=\"{5} 0.015\" "
        "euler=\"1.5707963 0 0\" mass=\"1\" friction=\"1.2 0.01 0.001\"/></body>",
        name, axle, side * half_track, radius, is_mirrored && side < 0 ? -1 : 1, radius);
  }
  std::string Servos() const {
    std::string servos;
    if (servo == "tendons") {
      const int right = is_mirrored ? -1 : 1;
      return fmt::format(
          "<tendon><fixed name=\"ahead\"><joint joint=\"left\" coef=\"0.5\"/><joint "
          "joint=\"right\" coef=\"{0}\"/></fixed><fixed name=\"turn\"><joint joint=\"left\" "
          "coef=\"-0.5\"/><joint joint=\"right\" coef=\"{0}\"/></fixed></tendon><actuator>"
          "<velocity name=\"a\" tendon=\"ahead\" kv=\"20\"/><velocity name=\"b\" tendon=\"turn\" "
          "kv=\"20\"/></actuator>",
          0.5 * right);
    }
    const std::string gains = servo == "velocity"      ? "kv=\"15\""
                              : servo == "position"    ? "kp=\"300\" kv=\"15\""
                              : servo == "intvelocity" ? "kp=\"9\" actrange=\"-9 9\""
                                                       : "gear=\"2\"";
    return fmt::format(
        "<actuator><{0} name=\"a\" joint=\"left\" {1}/><{0} name=\"b\" joint=\"right\" "
        "{1}/></actuator>",
        servo, gains);
  }
  std::string Castor(double at) const {
    return fmt::format(
        "<geom type=\"sphere\" size=\"0.03\" pos=\"{} 0 0.031\" condim=\"1\" "
        "priority=\"2\" mass=\"0.2\"/>",
        axle + at);
  }
  RobotConfig Write(ModelFolder& folder) const {
    RobotConfig config;
    config.name = "cart";
    config.model = folder.Write(
        "cart",
        fmt::format(
            "<compiler angle=\"radian\"/><worldbody><body name=\"root\" pos=\"0 0 "
            "{0}\"><freejoint/><geom size=\"0.001\" mass=\"0.01\" contype=\"0\" "
            "conaffinity=\"0\"/><body pos=\"0 0 {1}\" euler=\"0 0 {2}\"><geom type=\"box\" "
            "size=\"0.15 0.1 0.03\" pos=\"{3} 0 0.1\" mass=\"12\"/>{4}{5}{6}{7}</body></body>"
            "</worldbody>{8}",
            origin_height, -origin_height, heading, axle, Castor(0.16), Castor(-0.16),
            Wheel("left", 1), Wheel("right", -1), Servos()));
    config.root_body = "root";
    config.base.kind = BaseKind::kPlanar;
    config.move_groups["base"] = {
        .kind = MoveGroupKind::kBase, .joints = {"left", "right"}, .actuators = {"a", "b"}};
    return config;
  }
};

Scene OnFloor(const RobotConfig& config) {
  SceneSpec spec = SceneWith({.name = config.name, .config = config, .pos = {0.3, -0.2, 0}});
  spec.timestep = 0.002;
  spec.add_floor = true;
  return Scene::Build(spec);
}

Cart RandomCart(int seed) {
  Rng rng = Rng::Stream(seed, "wheels");
  Cart cart{.radius = rng.Uniform(0.06, 0.12), .half_track = rng.Uniform(0.12, 0.25)};
  cart.heading = seed % 3 == 0 ? rng.Uniform(-1.4, 1.4) : 0;
  cart.axle = seed % 2 == 0 ? rng.Uniform(-0.15, 0.15) : 0;
  cart.origin_height = seed % 2 == 1 ? cart.radius : 0;
  cart.servo =
      std::array{"velocity", "motor", "position", "tendons"}[static_cast<size_t>(seed % 4)];
  cart.is_mirrored = seed % 5 == 1;
  return cart;
}

TEST(WheeledBase, DrivesToPlacesWhateverItsWheelsAndServos) {
  for (int seed = 0; seed < 4; ++seed) {
    ModelFolder folder;
    const Cart cart = RandomCart(seed);
    const std::string what = fmt::format("{} ({})", seed, cart.servo);
    Scene scene = OnFloor(cart.Write(folder));
    Robot robot = Robot::Of(scene, "cart");
    BaseGroup& base = robot.base();
    ASSERT_EQ(base.nq(), 3);
    EXPECT_NEAR(base.pose().translation().z(), 0, 1e-6) << what;
    Rng rng = Rng::Stream(seed, "goals");
    // Ahead and aside; behind, near; on the spot.
    const std::vector<std::vector<double>> goals = {
        {rng.Uniform(0.5, 1), rng.Uniform(-0.8, 0.8), rng.Uniform(-3, 3)},
        {0.3, -0.2, rng.Uniform(-3, 3)}};
    for (const std::vector<double>& goal : goals) {
      double fastest = 0;
      for (int i = 0; i < 4000; ++i) {
        if (i % 33 == 0) robot.Apply({{"base", GroupCommand::Joints(goal)}});
        robot.Update();
        ASSERT_TRUE(robot.Step().ok());
        const std::vector<double> v = base.joint_vel();
        fastest = std::max(fastest, std::hypot(v[0], v[1]));
      }
      const std::vector<double> at = base.joint_pos();
      EXPECT_LT(std::hypot(at[0] - goal[0], at[1] - goal[1]), 0.03) << what;
      EXPECT_LT(std::abs(std::remainder(at[2] - goal[2], 2 * M_PI)), 0.05) << what;
      EXPECT_LT(fastest, 1.3) << what;
      for (const double v : base.joint_vel()) EXPECT_LT(std::abs(v), 0.02) << what;
      EXPECT_NEAR(base.pose().translation().z(), 0, 0.005) << what;
    }
  }
}

TEST(WheeledBase, IsPutAnywhereOnTheFloorAndStaysThere) {
  ModelFolder folder;
  Scene scene = OnFloor(Cart{.axle = 0.1, .origin_height = 0.1}.Write(folder));
  Robot robot = Robot::Of(scene, "cart");
  BaseGroup& base = robot.base();
  robot.Apply({{"base", GroupCommand::Joints({2, 2, 1})}});
  const Pose placed = Pose::FromRpy({-1, 0.5, 0}, {0, 0, 2});
  for (int i = 0; i < 200; ++i) {
    if (i == 100) base.SetPose(placed);
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_TRUE(base.pose().is_close(placed, 5e-3, 5e-3));
  const PlanarMotion* motion = PlanarMotion::Of(base);
  ASSERT_TRUE(motion);
  EXPECT_FALSE(motion->drives_sideways());
  EXPECT_TRUE(motion->drive_frame().is_close(Pose(Eigen::Vector3d(0.1, 0, 0)), 1e-9, 1e-9));
  EXPECT_NEAR(motion->JointsAt(placed, std::array{0.0, 0.0, 2 + 4 * M_PI})[2], 2 + 4 * M_PI, 1e-9);
}

// A target that is set once the base was put somewhere is not that of before.
TEST(WheeledBase, DrivesToATargetThatIsSetAfterItWasPut) {
  ModelFolder folder;
  Scene scene = OnFloor(Cart().Write(folder));
  Robot robot = Robot::Of(scene, "cart");
  BaseGroup& base = robot.base();
  const std::vector<double> first = scene.state();
  for (const bool whole_state : {false, true}) {
    robot.Apply({{"base", GroupCommand::Joints({0.3, 0.2, 1})}});
    if (whole_state)
      scene.SetState(first);
    else
      base.SetPose(Pose::FromRpy({1, 0.5, 0}, {0, 0, 0}));
    EXPECT_EQ(robot.controller("base").commanded_joint_pos()[0], base.joint_pos()[0]);
    const std::vector<double> goal = {base.joint_pos()[0] + 0.4, base.joint_pos()[1], 0};
    robot.Apply({{"base", GroupCommand::Joints(goal)}});
    for (int i = 0; i < 1000; ++i) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
    EXPECT_NEAR(base.joint_pos()[0], goal[0], 0.03);
  }
}

// The limits of its speed do not depend on how often the controller runs.
TEST(WheeledBase, DrivesAsFastWithLongTicks) {
  ModelFolder folder;
  Scene scene = OnFloor(Cart().Write(folder));
  Robot robot = Robot::Of(scene, "cart");
  double fastest = 0;
  robot.Apply({{"base", GroupCommand::Joints({3.3, -0.2, 0})}});
  for (int i = 0; i < 60; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.StepN(25).ok());
    fastest = std::max(fastest, robot.base().joint_vel()[0]);
  }
  EXPECT_NEAR(fastest, WheeledBase::kMostSpeeds.linear, 0.15);
}

TEST(WheeledBase, RejectsWheelsThatCannotDriveIt) {
  const auto why = [](const Cart& cart, const auto& change) -> std::string {
    ModelFolder folder;
    RobotConfig config = cart.Write(folder);
    change(config);
    try {
      Robot::Of(OnFloor(config), "cart");
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(why({}, [](RobotConfig& c) { c.control["base"] = ControlKind::kJointPosition; }),
              HasSubstr("this group only has the controller 'unicycle'"));
  EXPECT_THAT(why({}, [](RobotConfig& c) { c.move_groups.clear(); }),
              HasSubstr("For a base on wheels, name their joints and actuators in a group"));
  EXPECT_THAT(why({.servo = "intvelocity"}, [](RobotConfig&) {}),
              HasSubstr("Wheels are driven by velocity servos, motors or position servos"));
  EXPECT_THAT(why({.half_track = 0.001}, [](RobotConfig&) {}),
              HasSubstr("the wheels are behind each other"));
}

TEST(WheeledBase, TheBuiltInCartIsOne) {
  Scene scene = OnFloor(RobotConfig::Load(assets::BuiltinRobotFile("cart")));
  Robot robot = Robot::Of(scene, "cart");
  EXPECT_EQ(robot.controller("base").kind(), "unicycle");
  for (int i = 0; i < 500; ++i) {
    if (i == 0) robot.Apply({{"base", GroupCommand::Joints({0.5, -0.2, 0})}});
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_NEAR(robot.base().joint_pos()[0], 0.5, 0.02);
}

}  // namespace
}  // namespace robocell::internal
