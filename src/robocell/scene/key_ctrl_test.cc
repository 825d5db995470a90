// Tests the scene's key `home`: the state after a reset.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

class HomeKey : public ::testing::Test {
 protected:
  double Joint(const Scene& scene, const std::string& name) {
    return scene.data()
        ->qpos[scene.model()->jnt_qposadr[RequireId(scene.model(), mjOBJ_JOINT, name, "")]];
  }

  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  RobotConfig config = ArmConfig(folder.Write("arm", kTwoJointArm));
  AttachmentSpec gripper{.mjcf_path = folder.Write("gripper", kTwoFingerGripper),
                         .attach_to = Site("flange"),
                         .prefix = "g_"};
};

TEST_F(HomeKey, IsUniqueAndHoldsEveryRobotAtItsHome) {
  spec.robots.push_back({.config = config, .prefix = ""});  // brings a key `home` of its own
  config.home["arm"] = {0.5, 0.6};
  spec.robots.push_back({.config = config, .prefix = "b_", .pos = {0, 2, 0}});
  const Scene scene = Scene::Build(spec);
  ASSERT_EQ(scene.model()->nkey, 1);
  EXPECT_EQ(ElementName(scene.model(), mjOBJ_KEY, 0), "home");
  EXPECT_EQ(scene.compiled()->home_key(), 0);
  EXPECT_EQ(Joint(scene, "shoulder"), 0.3);
  EXPECT_EQ(scene.actuator_ctrl("servo1"), 0.31)
      << "the model's own control goes with its own home";
  EXPECT_EQ(Joint(scene, "b_elbow"), 0.6);
  EXPECT_DOUBLE_EQ(scene.actuator_ctrl("b_servo2"), 0.6) << "a servo holds the configured home";
}

TEST_F(HomeKey, HoldsAConfiguredHomeWithUnlistedServos) {
  config.move_groups.at("arm").actuators = {};
  config.home["arm"] = {0.5, 0.6};
  spec.robots.push_back({.config = config});
  const Scene scene = Scene::Build(spec);
  EXPECT_DOUBLE_EQ(scene.actuator_ctrl("servo1"), 0.5) << "not the control of the model's own key";
  EXPECT_DOUBLE_EQ(scene.actuator_ctrl("servo2"), 0.6);
}

TEST_F(HomeKey, HoldsAGripperAtItsHome) {
  config.attachments.push_back(gripper);
  config.move_groups["gripper"] = {.kind = MoveGroupKind::kGripper,
                                   .joints = {"g_left_slide", "g_right_slide"},
                                   .actuators = {"g_grip"},
                                   .ctrl = GripperCtrl{.open = 255, .closed = 0}};
  config.home["gripper"] = {0.03, 0.03};
  spec.robots.push_back({.config = config});
  Scene scene = Scene::Build(spec);
  EXPECT_NEAR(scene.actuator_ctrl("g_grip"), 1000 * 0.03 / 0.1568627, 1e-9);
  EXPECT_TRUE(scene.StepN(500).ok());
  EXPECT_NEAR(Joint(scene, "g_left_slide"), 0.03, 1e-3);
}

TEST_F(HomeKey, OpensAGripperWithoutAHome) {
  config.attachments.push_back(gripper);
  config.move_groups["gripper"] = {.kind = MoveGroupKind::kGripper,
                                   .joints = {"g_left_slide", "g_right_slide"},
                                   .actuators = {"g_grip"},
                                   .ctrl = GripperCtrl{.open = 255, .closed = 0}};
  spec.robots.push_back({.config = config});
  EXPECT_EQ(Scene::Build(spec).actuator_ctrl("g_grip"), 255);
}

TEST_F(HomeKey, KeepsTheModelHomeOfUnconfiguredJoints) {
  config.move_groups.clear();
  config.move_groups["upper"] = {
      .kind = MoveGroupKind::kGeneric, .joints = {"shoulder"}, .actuators = {"servo1"}};
  config.home["upper"] = {-1};
  spec.robots.push_back({.config = config});
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(Joint(scene, "shoulder"), -1);
  EXPECT_EQ(scene.actuator_ctrl("servo1"), -1);
  EXPECT_EQ(Joint(scene, "elbow"), -0.4);
  EXPECT_EQ(scene.actuator_ctrl("servo2"), -0.41);
}

// An arm whose own keyframe is in degrees.
std::string InDegrees() {
  std::string arm = kTwoJointArm;
  return arm.replace(arm.find("0.3 -0.4"), 8, "90 -0.4");
}

TEST_F(HomeKey, ReportsTheFileOfAKeyframeInDegrees) {
  config.model = folder.Write("degrees", InDegrees());
  spec.robots.push_back({.name = "bob", .config = config});
  try {
    Scene::Build(spec);
    FAIL() << "no error";
  } catch (const SpecError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("robot 'bob': keyframe 'home' of " + config.model +
                          ": 90 is outside the limits -2 to 2 of joint 'shoulder'; radians, and 90 "
                          "degrees are 1.5708"));
  }
  spec.robots.clear();
  config.home["arm"] = {0.5, 0.6};  // instead of the keyframe
  spec.robots.push_back({.name = "bob", .config = config});
  EXPECT_EQ(Joint(Scene::Build(spec), "shoulder"), 0.5);
}

TEST_F(HomeKey, IncludesTheHomeOfTheBaseScene) {
  spec.base = folder.Write(
      "lab",
      R"(<worldbody><body name="door"><joint name="hinge"/><geom size="0.1"/></body></worldbody>
      <keyframe><key name="home" qpos="0.7"/><key name="other" qpos="0.1"/></keyframe>)");
  spec.objects.push_back(BoxObject("cube", {0, 0, 1}));
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(scene.keyframes(), (std::vector<std::string>{"home", "other"}));
  EXPECT_EQ(Joint(scene, "hinge"), 0.7);
  EXPECT_NEAR(scene.body_pose("cube").translation().z(), 1, 1e-12);
}

TEST_F(HomeKey, ReadsJointsOfAllSizesInTheEnginesOrder) {
  const std::string odd = folder.Write("odd", R"(<worldbody><body name="root"><geom size="0.1"/>
      <body name="a"><geom size="0.1"/><body name="a2"><joint name="deep"/><geom size="0.1"/></body><joint name="ball" type="ball"/></body>
      <frame pos="0 0 1"><body name="b"><joint name="last" type="slide"/><geom size="0.1"/></body></frame></body></worldbody>
      <keyframe><key name="home" qpos="0 0 1 0 0.5 0.25"/></keyframe>)");
  spec.robots.push_back({.path = odd});
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  EXPECT_EQ(scene.data()->qpos[m->jnt_qposadr[RequireId(m, mjOBJ_JOINT, "ball", "")] + 2], 1);
  EXPECT_EQ(Joint(scene, "deep"), 0.5);
  EXPECT_EQ(Joint(scene, "last"), 0.25);
}

TEST_F(HomeKey, HoldsRealRobotsStill) {
  REQUIRE_MENAGERIE("ufactory_xarm7", "kinova_gen3", "robotiq_2f85");
  spec.robots = {Gen3With2F85("k_"), XArm7With2F85("x_")};
  spec.robots.push_back({.config = XArm7Config(), .prefix = "t_"});
  spec.robots[1].pos = {0, 1, 0};
  spec.robots[2].pos = {0, -1, 0};
  Scene scene = Scene::Build(spec);
  const std::vector<std::string> frames = {"k_bracelet_link", "x_link7", "t_link7"};
  std::vector<Pose> before;
  for (const std::string& frame : frames) before.push_back(scene.body_pose(frame));
  EXPECT_TRUE(scene.StepN(500).ok());
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_TRUE(scene.body_pose(frames[i]).is_close(before[i], 0.05, 0.03))
        << frames[i] << scene.body_pose(frames[i]) << before[i];
  }
}

}  // namespace
}  // namespace robocell::internal
