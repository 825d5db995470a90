// Tests the keyframes of parts' own models in a scene, and resets to them.
#include "robocell/scene/scene_keys.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/scene_cache.h"
#include "robocell/scene/testing/keyed_arms.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class SceneKeys : public KeyedArms {};

TEST_F(SceneKeys, OfAModelAreSelectedByNumberAndName) {
  AddArm(kHomeAndRetract);
  Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.keyframes(), ElementsAre("home", "retract"));
  EXPECT_EQ(scene.joint_pos("elbow"), -0.4);
  EXPECT_EQ(scene.Reset({.keyframe = 1}).keyframe, 1);
  EXPECT_EQ(scene.joint_pos("elbow"), -1.5);
  EXPECT_EQ(scene.actuator_ctrl("servo2"), -1.5);
  scene.Reset();
  EXPECT_EQ(scene.joint_pos("elbow"), -0.4);
  EXPECT_EQ(scene.Reset({.keyframe = "retract"}).keyframe, 1);
  EXPECT_EQ(scene.joint_pos("elbow"), -1.5);
}

// A body with a free joint, whose key `home` lifts, turns and throws it.
std::string Dog(const std::string& joint) {
  return R"(<worldbody><body name="trunk" pos="0 0 0.5"><freejoint )" + joint +
         R"(/><geom type="box" size="0.2 0.1 0.05" mass="5"/>
    <body name="leg" pos="0.15 0 0"><joint name="hip" axis="0 1 0"/><geom size="0.02" mass="1"/>
    </body></body></worldbody><actuator><position name="hip" joint="hip" kp="100" kv="5"/></actuator>
    <keyframe><key name="home" qpos="0.1 0 0.27 0.9238795 0 0 0.3826834 0.9" ctrl="0.9"/>
    <key name="jump" qpos="0 0.2 1 0.7071068 0.7071068 0 0 0.3" qvel="1 0 2 0 0 3 0"/></keyframe>)";
}

Pose RootIn(const Scene& scene, const std::string& body) { return scene.body_pose(body); }

TEST_F(SceneKeys, OfAFreeRootCountFromWhereTheSpecPutsTheRobot) {
  const Pose home({0.1, 0, 0.27}, Pose::FromRpy({0, 0, 0}, {0, 0, M_PI / 4}).quaternion());
  for (const std::string joint : {"name='root'", ""}) {
    spec = EmptyScene();
    const std::string dog = folder.Write("dog", Dog(joint));
    for (const auto& [name, y] : {std::pair{"l", 0.8}, {"r", -0.8}}) {
      spec.robots.push_back({.path = dog,
                             .prefix = std::string(name) + "_",
                             .pos = {2 * y, y, 0.1},
                             .euler = {0, 0, 100 * y}});
    }
    Scene scene = Scene::Build(spec);
    for (const RobotSpec& robot : spec.robots) {
      EXPECT_TRUE(RootIn(scene, robot.prefix + "trunk").is_close(robot.pose() * home, 1e-7, 1e-9))
          << robot.prefix << joint;
      EXPECT_EQ(scene.joint_pos(robot.prefix + "hip"), 0.9);
    }
    scene.Reset({.keyframe = "l_jump"});
    const Pose jump = spec.robots[0].pose() *
                      Pose({0, 0.2, 1}, Pose::FromRpy({0, 0, 0}, {M_PI / 2, 0, 0}).quaternion());
    EXPECT_TRUE(RootIn(scene, "l_trunk").is_close(jump, 1e-7, 1e-9));
    EXPECT_TRUE(RootIn(scene, "r_trunk").is_close(spec.robots[1].pose() * home, 1e-7, 1e-9));
  }
}

TEST_F(SceneKeys, OfAFreeRootGiveHeightAndTiltWhereTheFilesRootPoseIsDropped) {
  spec.robots.push_back({.path = folder.Write("dog", Dog("")),
                         .prefix = "d_",
                         .reset_root_pose = true,
                         .pos = {1, 2, 0},
                         .euler = {0, 0, 30}});
  Scene scene = Scene::Build(spec);
  EXPECT_TRUE(
      RootIn(scene, "d_trunk").is_close(Pose::FromRpy({1, 2, 0.27}, {0, 0, M_PI / 6}), 1e-7, 1e-9));
  scene.Reset({.keyframe = "d_jump"});
  EXPECT_TRUE(RootIn(scene, "d_trunk")
                  .is_close(Pose::FromRpy({1, 2, 1}, {M_PI / 2, 0, M_PI / 6}), 1e-7, 1e-9));
}

TEST_F(SceneKeys, OfAFreeRootTurnItsVelocityWithIt) {
  spec.robots.push_back(
      {.path = folder.Write("dog", Dog("")), .prefix = "d_", .euler = {0, 0, 90}});
  Scene scene = Scene::Build(spec);
  scene.Reset({.keyframe = "d_jump"});
  const std::vector<double> velocity(scene.data()->qvel, scene.data()->qvel + 6);
  EXPECT_THAT(velocity, ::testing::Pointwise(::testing::DoubleNear(1e-7),
                                             std::vector<double>{0, 1, 2, 0, 0, 3}));
}

TEST_F(SceneKeys, OfObjectsDoNotMoveTheirRoot) {
  for (const std::string joint : {"name='root'", ""}) {
    SceneObject object{.name = "dog", .pos = Vec3{0.5, 0, 0.4}};
    object.mjcf_path = folder.Write("dog", Dog(joint));
    spec.objects = {object};
    Scene scene = Scene::Build(spec);
    EXPECT_TRUE(RootIn(scene, "dog_trunk").is_close(Pose({0.5, 0, 0.9}), 1e-12, 1e-12));
    EXPECT_EQ(scene.joint_pos("dog_hip"), 0.9);
    scene.Reset({.keyframe = "dog_jump"});
    EXPECT_TRUE(RootIn(scene, "dog_trunk").is_close(Pose({0.5, 0, 0.9}), 1e-12, 1e-12));
    EXPECT_EQ(scene.joint_pos("dog_hip"), 0.3);
    EXPECT_EQ(scene.data()->qvel[0], 0);
  }
}

// Two objects, one of whose names begins with the other's.
TEST_F(SceneKeys, OfEqualNamesAreSelectedByPart) {
  const auto add = [&](const std::string& name, const std::string& keys, double x) {
    SceneObject object{.name = name, .pos = Vec3{x, 0, 1}};
    object.mjcf_path = folder.Write(name, R"(<worldbody><body name="b">
      <joint name="j" axis="0 1 0"/><geom size="0.1" mass="1"/></body></worldbody>
      <keyframe>)" + keys + "</keyframe>");
    spec.objects.push_back(object);
  };
  add("left", R"(<key name="arm_up" qpos="0.5"/>)", 0);
  add("left_arm", R"(<key name="up" qpos="0.7"/><key name="low" qpos="0.2"/>)", 1);
  Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.keyframes(),
              ElementsAre("home", "left_arm_up", "left_arm_up_2", "left_arm_low"));
  EXPECT_THAT(scene.compiled()->notes(),
              Contains(HasSubstr("its keyframe 'up' is called 'left_arm_up_2' in the scene")));
  const auto reset = [&](const std::string& part, const std::string& key) {
    scene.Reset({.keyframe = KeyframeChoice{PartKeyframes{{part, key}}}});
    return std::pair(scene.joint_pos("left_j"), scene.joint_pos("left_arm_j"));
  };
  EXPECT_EQ(reset("left", "arm_up"), std::pair(0.5, 0.0));
  EXPECT_EQ(reset("left_arm", "up"), std::pair(0.0, 0.7));
  EXPECT_EQ(reset("left_arm", "low"), std::pair(0.0, 0.2));
  ExpectThrow<NotFoundError>([&] { reset("left", "arm_low"); }, "arm_low");
  // The same holds for a scene from the cache.
  const TempDir cache;
  CompileSceneCached(spec, cache.path());
  Scene cached = Scene::FromCompiled(CompileSceneCached(spec, cache.path()));
  cached.Reset({.keyframe = KeyframeChoice{PartKeyframes{{"left_arm", "up"}}}});
  EXPECT_EQ(cached.joint_pos("left_arm_j"), 0.7);
  EXPECT_EQ(cached.joint_pos("left_j"), 0);
}

TEST_F(SceneKeys, OfRobotsKeepTheirNumbersAfterAddedObjects) {
  AddArm(kHomeAndRetract, "left_");
  AddArm(kHomeAndRetract, "right_", 1);
  Scene scene = Scene::Build(spec);
  const std::vector<std::string> of_robots = scene.keyframes();
  SceneObject door{.name = "door", .pos = Vec3{0, 2, 1}};
  door.mjcf_path = folder.Write("door", R"(<worldbody><body name="b"><joint name="j"/>
      <geom size="0.1" mass="1"/></body></worldbody>
      <keyframe><key name="ajar" qpos="0.1"/><key name="open" qpos="0.6"/></keyframe>)");
  scene.AddObject(door);
  std::vector<std::string> all = of_robots;
  all.insert(all.end(), {"door_ajar", "door_open"});
  EXPECT_EQ(scene.keyframes(), all);
  for (int i = 0; i < static_cast<int>(all.size()); ++i)
    EXPECT_EQ(scene.Reset({.keyframe = i}).keyframe, i);
  EXPECT_EQ(scene.joint_pos("door_j"), 0.6);
}

TEST_F(SceneKeys, OfOnePartAreSelectedByNumber) {
  AddArm(kHomeAndRetract, "left_");
  AddArm(kHomeAndRetract, "right_", 1);
  Scene scene = Scene::Build(spec);
  scene.Reset({.keyframe = PartKeyframes{{"left", 1}, {"right", 0}}});
  EXPECT_EQ(scene.joint_pos("left_shoulder"), 1);
  EXPECT_EQ(scene.joint_pos("right_shoulder"), 0.3);
  for (const int number : {-1, 2}) {
    ExpectThrow<ArgumentError>(
        [&] {
          scene.Reset({.keyframe = PartKeyframes{{"left", number}}});
        },
        "scene 'test' / 'left': there is no keyframe " + std::to_string(number) +
            "; its model has 2: home, retract");
  }
}

TEST_F(SceneKeys, DescribeUnnamedJoints) {
  SceneObject object{.name = "o", .pos = Vec3{0, 0, 1}};
  object.mjcf_path = folder.Write("o", R"(<worldbody><body name="b">
      <joint name="j0" axis="0 1 0"/><geom size="0.1" mass="1"/>
      <body pos="0.2 0 0"><joint axis="0 1 0"/><geom size="0.1" mass="1"/>
        <body pos="0.2 0 0"><joint name="joint1" axis="0 1 0" damping="1"/>
          <geom size="0.1" mass="1"/></body></body></body></worldbody>
      <actuator><motor joint="j0"/><motor name="m" joint="joint1"/></actuator>
      <keyframe><key name="home" qpos="0.3 0.4 0.5" ctrl="1 2"/>
        <key name="open" qpos="0.6 0.7 0.8" qvel="1 2 3" ctrl="3 4"/></keyframe>)");
  spec.objects.push_back(object);
  Scene scene = Scene::Build(spec);
  const auto numbers = [&] {
    const mjData* d = scene.data();
    return std::vector<double>{d->qpos[0], d->qpos[1], d->qpos[2], d->qvel[0],
                               d->qvel[1], d->qvel[2], d->ctrl[0], d->ctrl[1]};
  };
  EXPECT_THAT(numbers(), ElementsAre(0.3, 0.4, 0.5, 0, 0, 0, 1, 2));
  scene.Reset({.keyframe = "o_open"});
  EXPECT_THAT(numbers(), ElementsAre(0.6, 0.7, 0.8, 1, 2, 3, 3, 4));
}

TEST_F(SceneKeys, OfOneRobotKeepTheOthersAtHome) {
  AddArm(kHomeAndRetract, "left_");
  AddArm(kHomeAndRetract, "right_", 1);
  Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.keyframes(), ElementsAre("home", "left_retract", "right_retract"));
  scene.Reset({.keyframe = "right_retract"});
  EXPECT_EQ(scene.joint_pos("left_shoulder"), 0.3);
  EXPECT_EQ(scene.joint_pos("right_shoulder"), 1);
}

TEST_F(SceneKeys, OfSeveralRobotsAreComposed) {
  AddArm(kHomeAndRetract, "left_");
  AddArm(R"(<key name="fold" qpos="-1 0.5" qvel="0.2 0" ctrl="-1 0.5"/>)", "right_", 1);
  Scene scene = Scene::Build(spec);
  scene.Reset({.keyframe = KeyframeChoice{PartKeyframes{{"left", "retract"}, {"right", "fold"}}}});
  EXPECT_EQ(scene.joint_pos("left_shoulder"), 1);
  EXPECT_EQ(scene.joint_pos("right_shoulder"), -1);
  EXPECT_EQ(scene.actuator_ctrl("left_servo2"), -1.5);
  EXPECT_EQ(scene.actuator_ctrl("right_servo2"), 0.5);
  const int dof =
      scene.model()->jnt_dofadr[RequireId(scene.model(), mjOBJ_JOINT, "right_shoulder", "")];
  EXPECT_EQ(scene.data()->qvel[dof], 0.2);
  scene.Reset({.keyframe = KeyframeChoice{PartKeyframes{{"left", "retract"}, {"right", "home"}}}});
  EXPECT_EQ(scene.joint_pos("left_shoulder"), 1);
  EXPECT_EQ(scene.joint_pos("right_shoulder"), 0) << "the model has no home";
  scene.Reset();
  scene.Reset({.keyframe = "left: retract"});
  EXPECT_EQ(scene.joint_pos("left_shoulder"), 1) << "the same as one text";
}

TEST_F(SceneKeys, AsOneStringBelongToTheLongestPartName) {
  for (const bool longer_first : {true, false}) {
    spec.robots.clear();
    for (const bool longer : {longer_first, !longer_first}) {
      AddArm(kHomeAndRetract, longer ? "l_" : "s_", longer ? 1 : 0);
      spec.robots.back().name = longer ? "le:ft" : "le";
    }
    Scene scene = Scene::Build(spec);
    scene.Reset({.keyframe = "le:ft: retract"});
    EXPECT_EQ(scene.joint_pos("l_elbow"), -1.5);
    EXPECT_EQ(scene.joint_pos("s_elbow"), -0.4);
    scene.Reset({.keyframe = "le: retract"});
    EXPECT_EQ(scene.joint_pos("l_elbow"), -0.4);
    EXPECT_EQ(scene.joint_pos("s_elbow"), -1.5);
  }
}

TEST_F(SceneKeys, RejectUnknownNamesAndListTheKeyframes) {
  AddArm(kHomeAndRetract, "left_");
  Scene scene = Scene::Build(spec);
  ExpectThrow<ArgumentError>(
      [&] { scene.Reset({.keyframe = 2}); },
      "scene 'test': there is no keyframe 2; the scene has 2: home, left_retract");
  ExpectThrow<NotFoundError>([&] { scene.Reset({.keyframe = "left_retrac"}); },
                             "scene 'test': no keyframe 'left_retrac'. Its keyframes: home, "
                             "left_retract. Did you mean 'left_retract'? The keyframe 'retract' of "
                             "the model of 'left' is \"left: retract\", in Python also "
                             "{\"left\": \"retract\"}");
  ExpectThrow<NotFoundError>(
      [&] { scene.Reset({.keyframe = "retract"}); },
      "scene 'test': no keyframe 'retract'. Its keyframes: home, left_retract. Did you mean "
      "'left_retract'? The keyframe 'retract' of the model of 'left' is \"left: retract\", in "
      "Python also {\"left\": \"retract\"}");
  ExpectThrow<NotFoundError>([&] { scene.Reset({.keyframe = "left: retrct"}); },
                             "scene 'test' / 'left': no keyframe 'retrct'. Its keyframes: home, "
                             "retract. Did you mean 'retract'?");
  const auto of = [](const std::string& part, const std::string& key) {
    return ResetOptions{.keyframe = PartKeyframes{{part, key}}};
  };
  ExpectThrow<NotFoundError>([&] { scene.Reset(of("left", "retrct")); },
                             "scene 'test' / 'left': no keyframe 'retrct'. Its keyframes: home, "
                             "retract. Did you mean 'retract'?");
  ExpectThrow<NotFoundError>([&] { scene.Reset(of("lef", "retract")); },
                             "scene 'test': keyframe: no part 'lef'. Its parts: left. Did you "
                             "mean 'left'?");
}

TEST_F(SceneKeys, SurviveSavingAndTheCache) {
  AddArm(kHomeAndRetract, "left_");
  spec.objects.push_back(BoxObject("cube", {0, 0, 1}));
  Scene scene = Scene::Build(spec);
  const ModelPtr loaded = Compile(ParseXmlString(scene.ToXml()).get());
  ASSERT_EQ(loaded->nkey, 2);
  EXPECT_EQ(ElementName(loaded.get(), mjOBJ_KEY, 1), "left_retract");
  for (int i = 0; i < 2 * loaded->nq; ++i)
    EXPECT_NEAR(loaded->key_qpos[i], scene.model()->key_qpos[i], 1e-5);
  for (int i = 0; i < 2 * loaded->nu; ++i)
    EXPECT_NEAR(loaded->key_ctrl[i], scene.model()->key_ctrl[i], 1e-5);
  TempDir cache;
  CompileSceneCached(spec, cache.path());
  Scene again = Scene::FromCompiled(CompileSceneCached(spec, cache.path()));
  again.Reset({.keyframe = "left_retract"});
  EXPECT_EQ(again.joint_pos("left_elbow"), -1.5);
}

TEST_F(SceneKeys, StayWhenObjectsComeAndGo) {
  AddArm(kHomeAndRetract);
  Scene scene = Scene::Build(spec);
  scene.AddObject(BoxObject("cube", {0.5, 0, 1}));
  scene.Reset({.keyframe = "retract"});
  EXPECT_EQ(scene.joint_pos("elbow"), -1.5);
  EXPECT_NEAR(scene.body_pose("cube").translation().z(), 1, 1e-12);
}

TEST_F(SceneKeys, OfMultiInputActuatorsAreMappedCorrectly) {
  const std::string file = folder.Write("ball_arm", TwoJointArmWithABall());
  spec.robots.push_back({.path = file});
  const Scene scene = Scene::Build(spec);
  ExpectAsTheEngine(scene, file, "home");
  EXPECT_THAT(scene.compiled()->warnings(), Not(Contains(HasSubstr("keyframe"))));
}

TEST_F(SceneKeys, OfRealModelsAreComplete) {
  REQUIRE_MENAGERIE("kinova_gen3");
  const std::string file = MenagerieModel("kinova_gen3", "gen3.xml");
  spec.robots.push_back({.path = file, .control_modes = std::vector<CtrlMode>{}});
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.keyframes(), ElementsAre("home", "retract"));
  ExpectAsTheEngine(scene, file, "home");
  ExpectAsTheEngine(scene, file, "retract");
}

// Returns how far the joints are from a keyframe after a second without commands.
double Swing(const Scene& built, const ResetOptions& options = {}, bool with_weight = false) {
  Scene scene = built;
  if (!with_weight) scene.mutable_model()->opt.gravity[2] = 0;
  scene.Reset(options);
  const std::vector<double> start(scene.data()->qpos, scene.data()->qpos + scene.model()->nq);
  EXPECT_TRUE(scene.StepN(500).ok());
  double most = 0;
  for (size_t i = 0; i < start.size(); ++i)
    most = std::max(most, std::abs(scene.data()->qpos[i] - start[i]));
  return most;
}

class KeyControls : public KeyedArms {};

TEST_F(KeyControls, ThatDoNotHoldAreReplacedWithAWarning) {
  AddArm(R"(<key name="home" qpos="0.3 -0.4" ctrl="1.2 -0.4"/>
            <key name="up" qpos="1 1" ctrl="1 0"/>)");
  const Scene scene = Scene::Build(spec);
  EXPECT_LT(Swing(scene), 1e-6);
  EXPECT_LT(Swing(scene, {.keyframe = "up"}), 1e-6);
  const std::string file = spec.robots[0].config->model;
  EXPECT_THAT(scene.compiled()->warnings(),
              ::testing::IsSupersetOf({file + ": robot 'robot': keyframe 'home': controls do not "
                                              "hold its positions: 'servo1' 1.2 (0.3 holds). "
                                              "Without `update` the joints would swing away, so a "
                                              "reset sets the controls that hold. To say so in the "
                                              "file, write them into the keyframe",
                                       file + ": robot 'robot': keyframe 'up': controls do not "
                                              "hold its positions: 'servo2' 0 (1 holds). Without "
                                              "`update` the joints would swing away, so a reset "
                                              "sets the controls that hold. To say so in the file, "
                                              "write them into the keyframe"}));
}

TEST_F(KeyControls, ThatHoldGiveNoWarning) {
  AddArm(kHomeAndRetract);
  EXPECT_THAT(Scene::Build(spec).compiled()->warnings(), Not(Contains(HasSubstr("keyframe"))));
}

TEST_F(KeyControls, ThatCarryTheWeightAreKept) {
  // Weak servos that the weight pushes back by more than the slack.
  const auto build = [&](const std::string& key) {
    std::string arm = ArmWithKeys(key);
    arm.replace(arm.find("kp=\"100\" kv=\"10\""), 16, "kp=\"10\" kv=\"1\"");
    arm.replace(arm.find("kp=\"50\" kv=\"5\""), 14, "kp=\"5\" kv=\"0.5\"");
    spec.robots = {{.path = folder.Write("weak", arm)}};
    return Scene::Build(spec);
  };
  const Scene bare = build(R"(<key name="home" qpos="1.2 0" ctrl="1.2 0"/>)");
  const double lead1 = bare.data()->qfrc_bias[0] / 10, lead2 = bare.data()->qfrc_bias[1] / 5;
  ASSERT_GT(std::abs(lead1), 0.06);
  const Scene scene =
      build(fmt::format(R"(<key name="home" qpos="1.2 0" ctrl="{} {}"/>)", 1.2 + lead1, lead2));
  EXPECT_NEAR(scene.actuator_ctrl("servo1"), 1.2 + lead1, 1e-6);
  EXPECT_LT(Swing(scene, {}, true), 1e-3);
  EXPECT_GT(Swing(bare, {}, true), 0.03);
  EXPECT_THAT(scene.compiled()->warnings(), Not(Contains(HasSubstr("keyframe"))));
}

TEST_F(KeyControls, OfGrippersAndMotorsAreKept) {
  const std::string model = folder.Write("hand", R"(
    <compiler angle="radian"/><default><joint damping="1"/></default>
    <worldbody><body name="base"><geom size="0.05"/>
      <body name="arm" pos="0 0 0.2"><joint name="j" axis="0 1 0"/><geom size="0.02"/>
        <body name="l" pos="0 0.02 0.1"><joint name="l" type="slide" axis="0 1 0" range="0 0.04"/><geom size="0.005"/></body>
        <body name="r" pos="0 -0.02 0.1"><joint name="r" type="slide" axis="0 -1 0" range="0 0.04"/><geom size="0.005"/></body>
        <site name="tip" pos="0 0 0.1"/></body></body></worldbody>
    <actuator><motor name="mj" joint="j"/><position name="ml" joint="l" kp="100"/><position name="mr" joint="r" kp="100"/></actuator>
    <keyframe><key name="home" qpos="0 0.03 0.03" ctrl="0.7 0 0"/></keyframe>)");
  RobotConfig config{.name = "r", .model = model};
  config.move_groups["hand"] = {
      .kind = MoveGroupKind::kGripper, .joints = {"l", "r"}, .actuators = {"ml", "mr"}};
  spec.robots.push_back({.config = config});
  const Scene scene = Scene::Build(spec);
  EXPECT_EQ(scene.actuator_ctrl("mj"), 0.7);
  EXPECT_EQ(scene.actuator_ctrl("ml"), 0) << "closes with force";
  spec.robots[0].config->move_groups.clear();
  const Scene plain = Scene::Build(spec);
  EXPECT_EQ(plain.actuator_ctrl("mj"), 0.7);
  EXPECT_NEAR(plain.actuator_ctrl("ml"), 0.03, 1e-12) << "no gripper that the scene knows of";
}

// The servo integrates its control, so its activation holds.
TEST_F(KeyControls, OfServosThatIntegrateHold) {
  const auto arm = [&](const std::string& numbers) {
    return folder.Write(
        "int" + std::to_string(numbers.size()),
        R"(<compiler angle="radian"/><worldbody><body name="base"><geom size="0.05"/>
        <body name="a" pos="0 0 0.2"><joint name="j1" axis="0 1 0" damping="1"/><geom size="0.02" fromto="0 0 0 0 0 0.2" type="capsule"/></body></body></worldbody>
        <actuator><intvelocity name="m1" joint="j1" kp="500" kv="20" actrange="-2 2" ctrlrange="-1 1"/></actuator>
        <keyframe><key name="home" qpos="1" )" +
            numbers + "/></keyframe>");
  };
  for (const auto& [numbers, expected] :
       std::vector<std::pair<std::string, bool>>{{R"(act="1" ctrl="0")", false},
                                                 {"", false},
                                                 {R"(act="0.1" )", true},
                                                 {R"(act="1" ctrl="0.5")", true}}) {
    spec.robots = {{.path = arm(numbers)}};
    const Scene scene = Scene::Build(spec);
    EXPECT_LT(Swing(scene), 1e-6) << numbers;
    bool found = false;
    for (const std::string& warning : scene.compiled()->warnings())
      found |= warning.find("keyframe 'home': controls do not hold") != std::string::npos;
    EXPECT_EQ(found, expected) << numbers;
  }
}

TEST_F(KeyControls, OfAServoWithAScaleAndAnOffsetHold) {
  const std::string file = folder.Write("affine", R"(
      <compiler angle="radian"/><worldbody><body name="base"><geom size="0.05"/>
      <body name="a" pos="0 0 0.2"><joint name="j1" axis="0 1 0" damping="5"/><geom size="0.02" fromto="0 0 0 0 0 0.2" type="capsule"/></body></body></worldbody>
      <actuator><general name="m1" joint="j1" gainprm="2" biastype="affine" biasprm="-30 -100 -5"/></actuator>
      <keyframe><key name="home" qpos="0.5" ctrl="0"/></keyframe>)");
  spec.robots = {{.path = file}};
  const Scene scene = Scene::Build(spec);
  EXPECT_NEAR(scene.actuator_ctrl("m1"), (100 * 0.5 + 30) / 2, 1e-9);
  EXPECT_LT(Swing(scene), 1e-6);
}

TEST_F(KeyControls, ThatCannotReachGiveAWarning) {
  std::string arm = ArmWithKeys(R"(<key name="up" qpos="1.5 0"/>)");
  arm.replace(arm.find("name=\"servo1\""), 13, "name=\"servo1\" ctrlrange=\"-1 1\"");
  spec.robots = {{.path = folder.Write("short", arm)}};
  EXPECT_THAT(Scene::Build(spec).compiled()->warnings(),
              Contains(HasSubstr("keyframe 'up': no control in its range (ctrlrange, actrange) "
                                 "holds its positions; the nearest: 'servo1' 1.")));
}

}  // namespace
}  // namespace robocell::internal
