// Tests that a driven base moves to its target within its limits, and that its hand carries a cube.
#include "robocell/robot/driven_base.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/base_pose_controller.h"
#include "robocell/robot/testing/hands.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

const BaseConfig kDriven{.kind = BaseKind::kDriven};

// Both hands point down: the 2F-85 has its fingers along z of its base.
struct HandCase {
  std::string name;
  Vec3 euler;
  double above;  // height of the base over the cube that it grasps
};
void PrintTo(const HandCase& hand, std::ostream* out) { *out << hand.name; }

const HandCase kTwoFingerCase{"two_fingers", {0, 0, 0}, 0.115};
const HandCase k2f85Case{"2f85", {180, 0, 0}, 0.175};

RobotConfig ConfigOf(const HandCase& hand, const BaseConfig& base, ModelFolder& folder) {
  return hand.name == "2f85" ? Hand2f85(base) : TwoFingerHand(folder, base);
}

// A hand over a cube on the floor.
class CarriedCube : public ::testing::TestWithParam<HandCase> {
 protected:
  void SetUp() override {
    if (GetParam().name == "2f85") REQUIRE_MENAGERIE("robotiq_2f85");
  }
  Robot Hand(const BaseConfig& base = kDriven) { return HandOf(GetParam(), base); }
  Robot HandOf(const HandCase& hand, const BaseConfig& base) {
    SceneSpec spec = SceneWith({.name = "hand",
                                .config = ConfigOf(hand, base, folder_),
                                .prefix = "h_",
                                .pos = Vec3{0, 0, hand.above + 0.15},
                                .euler = hand.euler});
    spec.objects.push_back(BoxObject("cube", {0, 0, 0.02}));
    const Scene scene = Scene::Build(spec);
    return Robot::Of(scene, "hand");
  }
  // Updates and steps; returns the largest speeds of the base on the way.
  static BaseSpeeds Run(Robot& robot, double seconds) {
    Scene scene = robot.scene();
    BaseSpeeds most{0, 0};
    const int steps = static_cast<int>(seconds / scene.timestep());
    for (int i = 0; i < steps; ++i) {
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
      const std::vector<double> v = robot.base().joint_vel();
      most.linear = std::max(most.linear, std::hypot(v[0], v[1], v[2]));
      most.angular = std::max(most.angular, std::hypot(v[3], v[4], v[5]));
    }
    return most;
  }
  static void Grasp(Robot& robot) {
    BaseGroup& base = robot.base();
    const Pose down(Eigen::Vector3d(0, 0, -0.15));
    base.SetTarget(down * base.pose());
    Run(robot, 0.6);
    robot.gripper().Close();
    Run(robot, 0.8);
    ASSERT_TRUE(robot.gripper().is_grasping("cube"));
    base.SetTarget(down.inverse() * base.pose());
    Run(robot, 0.6);
  }
  static Pose CubeInHand(const Robot& robot) {
    return robot.base().pose().inverse() * robot.scene().body_pose("cube");
  }

  ModelFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Hands, CarriedCube, ::testing::Values(kTwoFingerCase, k2f85Case),
                         [](const auto& test) { return test.param.name; });

TEST_P(CarriedCube, FollowsTheHand) {
  Robot robot = Hand();
  Grasp(robot);
  BaseGroup& base = robot.base();
  EXPECT_GT(robot.scene().body_pose("cube").translation().z(), 0.15);
  const Pose held = CubeInHand(robot);
  const Pose away = Pose::FromRpy({0.3, -0.1, 0.1}, {0, 0, 1.5}) * base.pose();
  base.SetTarget(away);
  const BaseSpeeds most = Run(robot, 2);
  EXPECT_TRUE(base.pose().is_close(away, 2e-3, 1e-3))
      << (base.pose().translation() - away.translation()).norm();
  EXPECT_LE(most.linear, base.max_speeds().linear);
  EXPECT_LE(most.angular, base.max_speeds().angular);
  EXPECT_GT(most.angular, 0.8 * base.max_speeds().angular);
  EXPECT_TRUE(robot.gripper().is_grasping("cube"));
  EXPECT_TRUE(CubeInHand(robot).is_close(held, 0.05, 3e-3))
      << (CubeInHand(robot).translation() - held.translation()).norm();
  // Tilted, the cube hangs in the fingers.
  base.SetTarget(base.target() * Pose::FromRpy({0, 0, 0}, {0.5, 0, 0}));
  Run(robot, 2);
  EXPECT_TRUE(base.pose().is_close(base.target(), 2e-3, 1e-3));
  EXPECT_TRUE(CubeInHand(robot).is_close(held, 0.05, 3e-3))
      << (CubeInHand(robot).translation() - held.translation()).norm();
}

TEST_P(CarriedCube, StaysWithoutDrift) {
  Robot robot = Hand();
  Grasp(robot);
  Run(robot, 1);
  const Pose base = robot.base().pose();
  Run(robot, 4);
  EXPECT_TRUE(robot.base().pose().is_close(base, 1e-4, 1e-5));
  EXPECT_TRUE(robot.base().pose().is_close(robot.base().target(), 1e-3, 1e-4));
  EXPECT_TRUE(robot.gripper().is_grasping("cube"));
}

// A teleported hand leaves the cube behind.
TEST_P(CarriedCube, ATeleportLeavesItBehindWithAWarning) {
  for (const BaseKind kind : {BaseKind::kMocap, BaseKind::kDriven}) {
    std::vector<std::string> warnings;
    const ScopedLogSink sink([&](LogLevel, std::string_view text) { warnings.emplace_back(text); });
    Robot robot = Hand({.kind = kind});
    const Pose start = robot.base().pose();
    robot.base().SetPose(Pose(Eigen::Vector3d(0, 0, -0.15)) * start);
    EXPECT_TRUE(warnings.empty()) << warnings[0];
    robot.gripper().Close();
    for (int i = 0; i < 400; ++i) {
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
    }
    ASSERT_TRUE(robot.gripper().is_grasping("cube"));
    const Pose away = Pose(Eigen::Vector3d(0.3, 0, 0)) * robot.base().pose();
    robot.base().SetPose(away);
    EXPECT_TRUE(robot.base().pose().is_close(away, 1e-12, 1e-12));
    EXPECT_LT(robot.scene().body_pose("cube").translation().x(), 0.01);
    robot.base().SetPose(start);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_THAT(warnings[0],
                HasSubstr("robot 'hand' / group 'base': it is put elsewhere while gripper "
                          "'gripper' holds 'cube', which stays behind: setting a pose carries "
                          "nothing. To carry it, "));
    EXPECT_EQ(warnings[0].find("give the robot `base: {kind: driven}`") != std::string::npos,
              kind == BaseKind::kMocap);
  }
}

// Scene::SetBodyPose is the same teleport.
TEST_P(CarriedCube, AnyTeleportOfTheBaseLeavesItBehind) {
  for (const BaseKind kind : {BaseKind::kMocap, BaseKind::kDriven, BaseKind::kFree}) {
    std::vector<std::string> warnings;
    const ScopedLogSink sink([&](LogLevel, std::string_view text) { warnings.emplace_back(text); });
    Robot robot = Hand({.kind = kind});
    Scene scene = robot.scene();
    const std::string body = scene.compiled()->robot("hand").base_body;
    const Pose start = Pose(Eigen::Vector3d(0, 0, -0.15)) * robot.base().pose();
    const auto put = [&](double x) {
      scene.SetBodyPose(body, Pose(Eigen::Vector3d(x, 0, 0)) * start);
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
    };
    put(0);
    robot.gripper().Close();
    for (int i = 0; i < 400; ++i) put(0);
    ASSERT_TRUE(robot.gripper().is_grasping("cube"));
    if (kind != BaseKind::kFree) {  // it falls a little with every step, and is put back
      EXPECT_THAT(warnings, ::testing::IsEmpty()) << "it was put where it is";
    }
    put(0.3);
    EXPECT_LT(scene.body_pose("cube").translation().x(), 0.05);
    ASSERT_THAT(warnings, ::testing::SizeIs(1));
    EXPECT_THAT(warnings[0], HasSubstr(kind == BaseKind::kFree
                                           ? "which stays behind unless the fingers push it along:"
                                           : "which stays behind: setting a pose carries nothing"));
  }
}

class DrivenHand : public CarriedCube {
 protected:
  Robot Hand(const BaseConfig& base = kDriven) { return HandOf(kTwoFingerCase, base); }
};
INSTANTIATE_TEST_SUITE_P(One, DrivenHand, ::testing::Values(kTwoFingerCase));

TEST_P(DrivenHand, FollowsItsRamp) {
  Robot robot = Hand();
  BaseGroup& base = robot.base();
  const Pose start = base.pose();
  base.SetTarget(Pose(Eigen::Vector3d(0.4, 0, 0)) * start);
  PoseRamp ramp(start);
  for (int i = 0; i < 600; ++i) {
    ramp.Advance(base.target(), {0.48, 1.92, 4.8, 19.2}, robot.scene().timestep());
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
    ASSERT_TRUE(base.pose().is_close(ramp.pose(), 1e-3, 1.5e-3)) << "tick " << i;
  }
  EXPECT_TRUE(base.pose().is_close(base.target(), 1e-4, 1e-4));
}

TEST_P(DrivenHand, KeepsTheLimitsOfItsFile) {
  Robot robot =
      Hand({.kind = BaseKind::kDriven, .max_linear_speed = 0.1, .max_angular_speed = 0.5});
  BaseGroup& base = robot.base();
  EXPECT_EQ(base.max_speeds(), (BaseSpeeds{0.1, 0.5}));
  base.SetTarget(Pose::FromRpy({0.3, 0, 0}, {0, 0, 3}) * base.pose());
  BaseSpeeds most = Run(robot, 2);
  EXPECT_LE(most.linear, 0.1);
  EXPECT_GT(most.linear, 0.09);
  EXPECT_LE(most.angular, 0.5);
  EXPECT_GT(most.angular, 0.45);
  base.SetMaxSpeeds({.linear = 0.3, .angular = 1});
  most = Run(robot, 1);
  EXPECT_LE(most.angular, 1);
  EXPECT_GT(most.angular, 0.9);
  for (const BaseSpeeds wrong : {BaseSpeeds{0, 1}, BaseSpeeds{1, -1}, BaseSpeeds{1, NAN}})
    ExpectThrow<ArgumentError>([&] { base.SetMaxSpeeds(wrong); },
                               "robot 'hand' / group 'base': the largest speeds cannot be");
}

TEST_P(DrivenHand, RareUpdatesRespectTheLimits) {
  for (const int every : {2, 5, 10, 33}) {
    Robot robot = Hand();
    BaseGroup& base = robot.base();
    const Pose away = Pose(Eigen::Vector3d(0.3, 0, 0)) * base.pose();
    base.SetTarget(away);
    double most = 0;
    for (int i = 0; i < 3000; ++i) {
      if (i % every == 0) robot.Update();
      EXPECT_TRUE(robot.Step().ok());
      const std::vector<double> v = base.joint_vel();
      most = std::max(most, std::hypot(v[0], v[1], v[2]));
    }
    EXPECT_LE(most, base.max_speeds().linear) << every;
    if (every == 33) continue;  // still moving
    EXPECT_TRUE(base.pose().is_close(away, 1e-3, 1e-3)) << every;
  }
}

TEST_P(DrivenHand, IsCommandedByApply) {
  Robot robot = Hand();
  const Pose away = Pose(Eigen::Vector3d(0, 0.1, 0)) * robot.base().pose();
  EXPECT_TRUE(robot.Apply({{"base", GroupCommand::BasePose(away)}}).ok);
  EXPECT_EQ(robot.base().target(), away);
  EXPECT_EQ(robot.controller("base").kind(), kBasePoseController);
  ExpectThrow<ArgumentError>(
      [&] {
        robot.Apply({{"base", GroupCommand::LeafPose(away)}});
      },
      "its controller 'base_pose' takes a pose of the base in the world, not a pose");
  ExpectThrow<ArgumentError>(
      [&] {
        robot.controller("base").SetTarget(std::vector<double>{0, 0, 0});
      },
      "robot 'hand' / group 'base': expected 7 pose values, got 3");
  ExpectThrow<ArgumentError>(
      [&] {
        robot.controller("base").SetTarget(std::vector<double>{0, 0, 0, 2, 0, 0, 0});
      },
      "robot 'hand' / group 'base': the target pose: ");
}

TEST_P(DrivenHand, ATeleportPlacesItAtRest) {
  Robot robot = Hand();
  Scene scene = robot.scene();
  BaseGroup& base = robot.base();
  base.SetTarget(Pose(Eigen::Vector3d(0.3, 0, 0)) * base.pose());
  Run(robot, 0.3);
  const Pose placed = Pose::FromRpy({-0.2, 0.3, 0.6}, {0.1, -0.2, 2});
  const auto stays = [&] {
    EXPECT_TRUE(base.pose().is_close(placed, 1e-12, 1e-12));
    EXPECT_TRUE(base.target().is_close(placed, 1e-12, 1e-12));
    EXPECT_EQ(base.joint_vel(), std::vector<double>(6, 0.0));
    Run(robot, 0.3);
    EXPECT_TRUE(base.pose().is_close(placed, 1e-3, 1e-4));
  };
  base.SetPose(placed);
  stays();
  scene.Reset();
  scene.SetBodyPose("h_driven_base", placed);
  stays();
  scene.Reset({.body_poses = {{"h_driven_base", placed}}});
  stays();
  scene.Reset();
  std::vector<double> q(7);
  placed.ToWxyz(q.data(), q.data() + 3);
  base.SetJointPos(q);
  base.SetJointVel(std::vector<double>(6, 0.0));
  stays();
}

TEST_P(DrivenHand, AResetRestoresItAndClearsItsTarget) {
  Robot robot = Hand();
  Scene scene = robot.scene();
  const Pose start = robot.base().pose();
  robot.base().SetTarget(Pose(Eigen::Vector3d(0.3, 0, 0)) * start);
  Run(robot, 0.4);
  scene.Reset();
  EXPECT_EQ(robot.base().pose(), start);
  EXPECT_EQ(robot.base().target(), start);
  Run(robot, 0.2);
  EXPECT_TRUE(robot.base().pose().is_close(start, 1e-4, 1e-5));
}

TEST_P(DrivenHand, ContinuesToItsTargetWhenObjectsComeAndGo) {
  Robot robot = Hand();
  Scene scene = robot.scene();
  const Pose away = Pose(Eigen::Vector3d(0.3, 0, 0)) * robot.base().pose();
  robot.base().SetTarget(away);
  Run(robot, 0.3);
  const Pose before = robot.base().pose();
  scene.AddObject(BoxObject("other", {1, 1, 0.02}));
  EXPECT_TRUE(robot.base().pose().is_close(before, 1e-12, 1e-12));
  EXPECT_EQ(robot.base().target(), away);
  Run(robot, 0.1);
  scene.RemoveObject("other");
  Run(robot, 1);
  EXPECT_TRUE(robot.base().pose().is_close(away, 1e-4, 1e-4));
}

TEST_P(DrivenHand, SettingAStateRestoresTheTarget) {
  Robot robot = Hand();
  Scene scene = robot.scene();
  const Pose start = robot.base().pose();
  const std::vector<double> state = scene.state();
  robot.base().SetTarget(Pose(Eigen::Vector3d(0.3, 0, 0)) * start);
  Run(robot, 0.4);
  scene.SetState(state);
  EXPECT_TRUE(robot.base().target().is_close(start, 1e-12, 1e-12));
  Run(robot, 0.2);
  EXPECT_TRUE(robot.base().pose().is_close(start, 1e-4, 1e-5));
}

// This also holds before the first tick after SetTarget, when the engine has not moved anything
// yet, and after it has come to rest, where the state has the mocap body in its place.
TEST_P(DrivenHand, SettingAStateOrPoseClearsAPendingTarget) {
  Robot robot = Hand();
  Scene scene = robot.scene();
  BaseGroup& base = robot.base();
  for (const double ran : {0.0, 0.3}) {
    Run(robot, ran);
    const Pose here = base.pose(), away = Pose(Eigen::Vector3d(0.3, 0, 0)) * here;
    const std::vector<double> state = scene.state();
    const auto stays = [&] {
      EXPECT_TRUE(base.target().is_close(here, 1e-4, 1e-5));
      Run(robot, 0.3);
      EXPECT_TRUE(base.pose().is_close(here, 1e-4, 1e-5));
    };
    base.SetTarget(away);
    scene.SetState(state);
    stays();
    base.SetTarget(away);
    scene.SetBodyPose("h_driven_base", here);
    stays();
    base.SetTarget(away);
    scene.SetBodyPose("h_base_target", here);
    stays();
  }
  // Moving another body does not affect the base.
  const Pose away = Pose(Eigen::Vector3d(0.1, 0, 0)) * base.pose();
  base.SetTarget(away);
  scene.SetBodyPose("cube", Pose(Eigen::Vector3d(1, 1, 0.02)));
  EXPECT_EQ(base.target(), away);
}

TEST_P(DrivenHand, RejectsANonFiniteTarget) {
  Robot robot = Hand();
  BaseGroup& base = robot.base();
  const Pose here = base.pose();
  ExpectThrow<ArgumentError>([&] { base.SetTarget(Pose(Eigen::Vector3d(1e300, 0, 0))); },
                             "robot 'hand' / group 'base': the target is 1e+300 m away along an "
                             "axis of the world, which is too far");
  EXPECT_TRUE(base.target().is_close(here, 1e-9, 1e-9));
  robot.controller("base").command_port()[1] = -1e300;
  ExpectThrow<ArgumentError>([&] { robot.Update(); }, "the target is 1e+300 m away");
}

TEST_P(DrivenHand, RespectsItsLimitsWithLongTimesteps) {
  for (const double timestep : {0.0005, 0.002, 0.005, 0.01, 0.014, 0.018, 0.02}) {
    SceneSpec spec = SceneWith({.name = "hand",
                                .config = TwoFingerHand(folder_, kDriven),
                                .prefix = "h_",
                                .pos = Vec3{0, 0, 0.3}});
    spec.timestep = timestep;
    Robot robot = Robot::Of(Scene::Build(spec), "hand");
    BaseGroup& base = robot.base();
    for (const Vec3& turn : {Vec3{0, 0, 2}, Vec3{1, 0, 0}, Vec3{0, 2, 0}}) {
      const Pose away = Pose(Eigen::Vector3d(0.2, 0, 0.1)) * base.pose() *
                        Pose::FromRpy({0, 0, 0}, {turn[0], turn[1], turn[2]});
      base.SetTarget(away);
      const BaseSpeeds most = Run(robot, 3);
      EXPECT_LE(most.linear, base.max_speeds().linear) << timestep;
      EXPECT_LE(most.angular, base.max_speeds().angular) << timestep;
      EXPECT_TRUE(base.pose().is_close(away, 2e-3, 1e-4)) << timestep;
      const std::vector<double> v = base.joint_vel();
      EXPECT_LT(std::hypot(v[0], v[1], v[2]), 1e-3) << timestep;
      EXPECT_LT(std::hypot(v[3], v[4], v[5]), 1e-2) << timestep;
    }
  }
}

TEST_P(DrivenHand, ASecondRobotObjectChangesNothing) {
  Robot robot = Hand();
  const Pose away = Pose(Eigen::Vector3d(0.3, 0, 0)) * robot.base().pose();
  robot.base().SetTarget(away);
  Run(robot, 0.3);
  Robot again = Robot::Of(robot.scene(), "hand");
  EXPECT_EQ(again.base().target(), away);
  Run(again, 1);
  EXPECT_TRUE(again.base().pose().is_close(away, 1e-4, 1e-4));
}

// Stock MuJoCo holds the hand at its start, without robocell.
TEST_P(DrivenHand, ASavedFileHoldsItsPoseInStockMujoco) {
  Robot robot = Hand();
  const std::string file = (folder_.path() / "saved.xml").string();
  robot.scene().SaveXml(file);
  char error[1000] = "";
  mjModel* m = mj_loadXML(file.c_str(), nullptr, error, sizeof error);
  ASSERT_NE(m, nullptr) << error;
  mjData* d = mj_makeData(m);
  mj_resetDataKeyframe(m, d, 0);
  const int base = mj_name2id(m, mjOBJ_BODY, "h_driven_base");
  const double z = d->qpos[m->jnt_qposadr[m->body_jntadr[base]] + 2];
  for (int i = 0; i < 500; ++i) mj_step(m, d);
  EXPECT_NEAR(d->xpos[3 * base + 2], z, 1e-5);
  // Code that moves the target moves the hand.
  const int target = m->body_mocapid[mj_name2id(m, mjOBJ_BODY, "h_base_target")];
  d->mocap_pos[3 * target] += 0.05;
  for (int i = 0; i < 500; ++i) mj_step(m, d);
  EXPECT_NEAR(d->xpos[3 * base], 0.05, 1e-4);
  mj_deleteData(d);
  mj_deleteModel(m);
}

TEST_P(DrivenHand, OtherBasesHaveNoTarget) {
  Robot robot = Hand({.kind = BaseKind::kMocap});
  EXPECT_FALSE(robot.base().is_driven());
  for (const auto& call : std::initializer_list<std::function<void()>>{
           [&] { robot.base().target(); }, [&] { robot.base().SetTarget(Pose()); },
           [&] { robot.base().max_speeds(); }, [&] { robot.base().SetMaxSpeeds({}); }}) {
    ExpectThrow<ArgumentError>(call,
                               "robot 'hand' / group 'base': only a driven base moves to a target; "
                               "give the robot `base: {kind: driven}`, or set the base's pose, "
                               "which teleports it");
  }
}

// How deep anything is in what is not a part of the robot at most, while the base follows its
// target.
double DeepestContact(Robot& robot, double seconds) {
  Scene scene = robot.scene();
  double deepest = 0;
  for (int i = 0; i < static_cast<int>(seconds / scene.timestep()); ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
    for (const Contact& contact : scene.contacts()) {
      const bool inside_robot = contact.body1.starts_with("h_") && contact.body2.starts_with("h_");
      if (!inside_robot) deepest = std::max(deepest, -contact.distance);
    }
  }
  return deepest;
}

TEST_P(DrivenHand, AFloorStopsItAndItRetreatsAtOnce) {
  Robot robot = Hand();
  robot.scene().SetBodyPose("cube", Pose(Eigen::Vector3d(1, 1, 0.02)));
  BaseGroup& base = robot.base();
  const Pose start = base.pose();
  base.SetTarget(Pose(Eigen::Vector3d(0, 0, -0.3 - start.translation().z())) * start);
  EXPECT_LT(DeepestContact(robot, 3), 0.008);
  base.SetTarget(start);
  Run(robot, 1);
  EXPECT_TRUE(base.pose().is_close(start, 1e-3, 1e-3));
}

TEST_P(DrivenHand, AFloorStopsAPressedObject) {
  Robot robot = Hand();
  BaseGroup& base = robot.base();
  robot.gripper().Close();
  Run(robot, 0.5);
  base.SetTarget(Pose(Eigen::Vector3d(0, 0, -0.2)) * base.pose());
  EXPECT_LT(DeepestContact(robot, 3), 0.008);
}

TEST(DrivenArm, IsStoppedByFloorsAndWalls) {
  RobotConfig config = Rc7();
  config.base = kDriven;
  SceneSpec spec = SceneWith({.name = "rc7", .config = config, .pos = {0, 0, 0.5}});
  SceneObject wall{.name = "wall",
                   .shape = Shape::kBox,
                   .size = Vec3{0.02, 1, 1},
                   .rgba = Vec4{1, 1, 1, 1},
                   .mass = 1,
                   .friction = Vec3{1, 0.005, 0.0001},
                   .pos = Vec3{-0.6, 0, 1},
                   .fixed = true};
  spec.objects.push_back(wall);
  for (const Eigen::Vector3d& by : {Eigen::Vector3d(0, 0, -0.8), Eigen::Vector3d(-1.5, 0, 0.3)}) {
    Robot robot = Robot::Of(Scene::Build(spec), "rc7");
    const Pose start = robot.base().pose();
    robot.base().SetTarget(Pose(by) * start);
    EXPECT_LT(DeepestContact(robot, 5), 0.008) << by.transpose();
    robot.base().SetTarget(start);
    DeepestContact(robot, 3);
    EXPECT_TRUE(robot.base().pose().is_close(start, 1e-2, 1e-2)) << by.transpose();
  }
}

// A hand of boxes, which are given as in MJCF, and fixed boxes around it.
Robot HandAmong(ModelFolder& folder, const std::string& geoms, std::vector<SceneObject> fixed) {
  const std::string file =
      folder.Write("hand", "<worldbody><body name='palm'>" + geoms + "</body></worldbody>");
  RobotConfig config{.name = "hand", .model = file, .root_body = "palm"};
  config.base = kDriven;
  config.gravcomp = true;
  SceneSpec spec =
      SceneWith({.name = "hand", .config = config, .prefix = "h_", .pos = Vec3{0, 0, 0.5}});
  for (SceneObject& object : fixed) {
    object.fixed = true;
    spec.objects.push_back(object);
  }
  return Robot::Of(Scene::Build(spec), "hand");
}

SceneObject FixedBox(const std::string& name, const Vec3& pos, const Vec3& size) {
  SceneObject box = BoxObject(name, pos);
  box.size = size;
  return box;
}

TEST(DrivenTool, DoesNotTurnThroughWallsWhoseForcesCancelOut) {
  ModelFolder folder;
  Robot robot = HandAmong(folder,
                          "<geom type='box' size='.04 .04 .03' mass='.8' pos='0 0 .1'/>"
                          "<geom type='box' size='.03 .03 .06' mass='.2'/>",
                          {FixedBox("a", {0.042, 0, 0.5}, {0.01, 0.06, 0.04}),
                           FixedBox("b", {-0.042, 0, 0.5}, {0.01, 0.06, 0.04}),
                           FixedBox("c", {0, 0.042, 0.5}, {0.06, 0.01, 0.04}),
                           FixedBox("d", {0, -0.042, 0.5}, {0.06, 0.01, 0.04})});
  const Pose start = robot.base().pose();
  robot.base().SetTarget(start * Pose::FromRotvec({0, 0, 0}, {0, 0, 0.785}));
  EXPECT_LT(DeepestContact(robot, 3), 0.004);
  EXPECT_LT(robot.base().pose().rotvec().norm(), 0.3);
  robot.base().SetTarget(start);
  DeepestContact(robot, 1);
  EXPECT_TRUE(robot.base().pose().is_close(start, 1e-3, 2e-3));
}

TEST(DrivenTool, DoesNotSlipRoundWhatBlocksIt) {
  ModelFolder folder;
  Robot robot = HandAmong(folder, "<geom type='box' size='.3 .02 .02' mass='1'/>",
                          {FixedBox("post", {0.28, 0.1, 0.5}, {0.02, 0.02, 0.5})});
  const Pose start = robot.base().pose();
  robot.base().SetTarget(Pose(Eigen::Vector3d(0, 0.5, 0)) * start);
  EXPECT_LT(DeepestContact(robot, 10), 0.008);
  EXPECT_NEAR(robot.base().pose().translation().y(), 0.06, 0.015);
  EXPECT_LT(robot.base().pose().rotvec().norm(), 0.1);
}

// A hand, and a box below that a constraint of the base scene's file ties to it, without a contact
// between them. What holds is active or not.
class TiedLoad : public ::testing::TestWithParam<const char*> {
 protected:
  Robot HandWith(double mass, double height, bool active = true) {
    RobotConfig config{.name = "hand",
                       .model = folder_.Write("hand", R"(<worldbody>
      <body name="palm"><geom type="box" size=".03 .03 .03" mass=".5"/>
        <site name="cup" pos="0 0 -.1"/></body></worldbody>)"),
                       .root_body = "palm"};
    config.base = kDriven;
    config.gravcomp = true;
    SceneSpec spec = SceneWith(
        {.name = "hand", .config = config, .prefix = "h_", .pos = Vec3{0, 0, height + 0.1}});
    spec.base = folder_.Write(
        "cell",
        fmt::format("<worldbody><body name='load' pos='0 0 {}'><freejoint/><geom type='box' "
                    "size='.02 .02 .02' mass='{}' priority='1' friction='.2'/><site "
                    "name='top'/></body></worldbody>"
                    "<equality><{} name='cup' active='{}'/></equality>",
                    height, mass, GetParam(), active));
    return Robot::Of(Scene::Build(spec), "hand");
  }
  ModelFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(
    Constraints, TiedLoad,
    ::testing::Values("weld body1='h_palm' body2='load' relpose='0 0 -.1 1 0 0 0'",
                      "weld site1='h_cup' site2='top'",
                      "connect body1='h_palm' body2='load' anchor='0 0 -.1'",
                      "connect site1='top' site2='h_cup'"));

TEST_P(TiedLoad, StopsTheBaseWhereItMeetsTheFloorOrAWall) {
  Robot robot = HandWith(0.2, 0.4);
  const Pose start = robot.base().pose();
  robot.base().SetTarget(Pose(Eigen::Vector3d(0, 0, -0.45)) * start);
  EXPECT_LT(DeepestContact(robot, 3), 0.008);
  EXPECT_GT(robot.base().pose().translation().z(), 0.1) << "as high as its load holds it";
  EXPECT_NEAR(robot.base().target().translation().z(), 0.05, 1e-9) << "the target stays";
  robot.base().SetTarget(start);
  DeepestContact(robot, 2);
  EXPECT_TRUE(robot.base().pose().is_close(start, 1e-2, 1e-3));
}

// Holds a rod, which holds the box below: only the box meets the floor.
TEST(DrivenBase, StopsWhereALoadThatHangsOnItsLoadMeetsTheFloor) {
  ModelFolder folder;
  RobotConfig config{.name = "hand",
                     .model = folder.Write("hand", R"(<worldbody>
      <body name="palm"><geom type="box" size=".03 .03 .03" mass=".5"/></body></worldbody>)"),
                     .root_body = "palm"};
  config.base = kDriven;
  config.gravcomp = true;
  for (const bool is_tied : {true, false}) {
    SceneSpec spec =
        SceneWith({.name = "hand", .config = config, .prefix = "h_", .pos = Vec3{0, 0, 0.6}});
    spec.base = folder.Write(is_tied ? "tied" : "loose", fmt::format(R"(<worldbody>
      <body name="load" pos="0 0 .3"><freejoint/><geom type="box" size=".02 .02 .02" mass=".2"/>
      </body><body name="rod" pos="0 0 .5"><freejoint/>
        <geom type="box" size=".01 .01 .01" mass=".1"/></body></worldbody>
      <equality><weld body1="rod" body2="load" relpose="0 0 -.2 1 0 0 0" active="{}"/>
        <weld body1="h_palm" body2="rod" relpose="0 0 -.1 1 0 0 0"/></equality>)",
                                                                     is_tied));
    Robot robot = Robot::Of(Scene::Build(spec), "hand");
    const Pose start = robot.base().pose();
    robot.base().SetTarget(Pose(Eigen::Vector3d(0, 0, -0.45)) * start);
    DeepestContact(robot, 3);
    const double height = robot.base().pose().translation().z();
    if (is_tied)
      EXPECT_GT(height, 0.28) << "as high as both loads hold it";
    else
      EXPECT_LT(height, 0.2);
  }
}

TEST_P(TiedLoad, StopsNothingAfterItIsLetGo) {
  Robot robot = HandWith(0.2, 0.4, false);
  robot.base().SetTarget(Pose(Eigen::Vector3d(0.3, 0, -0.4)) * robot.base().pose());
  DeepestContact(robot, 3);
  EXPECT_TRUE(robot.base().pose().is_close(robot.base().target(), 1e-3, 1e-3));
  EXPECT_NEAR(robot.scene().body_pose("load").translation().x(), 0, 0.01);
}

// The floor carries it, with more than the hand alone may push.
TEST_P(TiedLoad, IsDraggedOverTheFloorThoughItIsHeavy) {
  Robot robot = HandWith(5, 0.02);
  robot.base().SetTarget(Pose(Eigen::Vector3d(0.3, 0, 0)) * robot.base().pose());
  DeepestContact(robot, 3);
  EXPECT_NEAR(robot.base().pose().translation().x(), 0.3, 2e-3);
  EXPECT_NEAR(robot.scene().body_pose("load").translation().x(), 0.3, 0.03);
}

TEST(DrivenArm, HoldsItsPoseOnAPedestal) {
  RobotConfig config = Rc7();
  config.base = {.kind = BaseKind::kDriven, .size = Vec3{0.2, 0.2, 0.2}};
  const Scene scene =
      Scene::Build(SceneWith({.name = "rc7", .config = config, .pos = {0, 0, 0.5}}));
  Robot robot = Robot::Of(scene, "rc7");
  const Pose start = robot.base().pose();
  robot.Apply({{"arm", GroupCommand::RelativeJoints({1, 0.3, 0, 0.4, 0, 0.5, 0})}});
  for (int i = 0; i < 500; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
    ASSERT_TRUE(robot.base().pose().is_close(start, 1e-2, 1e-3));  // the servos jump
  }
  EXPECT_TRUE(robot.base().pose().is_close(start, 1e-3, 1e-4));
}

TEST(DrivenBaseControl, RejectsOtherControllers) {
  RobotConfig config = Rc7();
  config.base = kDriven;
  config.move_groups["base"] = {.kind = MoveGroupKind::kBase};
  config.control["base"] = ControlKind::kJointPosition;
  ExpectThrow<ArgumentError>([&] { RobotAlone(config); },
                             "group 'base': `control` is joint_position, but this group only has "
                             "the controller 'base_pose'; leave it out of `control`");
}

}  // namespace
}  // namespace robocell::internal
