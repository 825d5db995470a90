// Tests robots: names, prefixes, attachments, overrides, tool points, and messages about misfits.
#include "robocell/scene/add_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <fstream>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/arm_scenes.h"
#include "robocell/scene/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Robots : public ArmScenes {};

TEST_F(Robots, GetTheirNamesFromThePrefix) {
  SceneSpec spec = EmptyScene();
  for (const char* prefix : {"", "left_", "arms/right/", "x"})
    spec.robots.push_back({.config = config, .prefix = prefix});
  spec.robots.push_back({.name = "spare", .config = config, .prefix = "y_"});
  const Scene scene = Scene::Build(spec);
  std::vector<std::string> names;
  for (const RobotRecord& robot : scene.compiled()->robots()) names.push_back(robot.name);
  EXPECT_THAT(names, ElementsAre("robot", "left", "arms_right", "x", "spare"));
  EXPECT_EQ(scene.compiled()->robot("arms_right").root_body, "arms/right/base");
  ExpectThrow<NotFoundError>([&] { scene.compiled()->robot("lefd"); },
                             "scene 'test': no robot 'lefd'. Its robots: robot, left, arms_right, "
                             "x, spare. Did you mean 'left'?");
}

TEST_F(Robots, RejectDuplicateNames) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = config, .prefix = "a_"});
  spec.robots.push_back({.config = config, .prefix = "a/"});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "robot 'a': two robots have this name; set `name`");
}

TEST_F(Robots, TwoOfTheSameKindAreIndependent) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = config, .prefix = "l_"});
  spec.robots.push_back({.config = config, .prefix = "r_", .pos = {0, 2, 0}});
  Scene scene = Scene::Build(spec);
  EXPECT_EQ(scene.model()->nu, 4 + 4) << "servos and motors";
  EXPECT_EQ(scene.model()->nsensor, 2);
  scene.SetActuatorCtrl("l_servo1", 1.0);
  EXPECT_TRUE(scene.StepN(500).ok());
  EXPECT_NEAR(scene.data()->qpos[RequireId(scene.model(), mjOBJ_JOINT, "r_shoulder", "")], 0.3,
              0.1);
  EXPECT_NEAR(scene.data()->qpos[RequireId(scene.model(), mjOBJ_JOINT, "l_shoulder", "")], 1.0,
              0.1);
}

TEST_F(Robots, TakeOnlyTheirRootAndReportTheRest) {
  const std::string room = folder.Write(
      "room", R"(<worldbody><light name="lamp"/><geom name="ground" type="plane" size="1 1 1"/>
      <body name="base"><joint name="turn" axis="0 0 1"/><geom size="0.1"/></body><body name="chair"><joint name="roll"/><geom size="0.1"/></body></worldbody>
      <actuator><motor name="m1" joint="turn"/><motor name="m2" joint="roll"/></actuator>)");
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = room});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / robot 'robot': " + room +
                             " has 2 root bodies: base, chair; say which one is the root_body");
  spec.robots[0] = {.config = RobotConfig{.name = "r", .model = room, .root_body = "base"}};
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(
      scene.compiled()->warnings(),
      ElementsAre(
          "robot 'robot': only body 'base' of " + room +
              " is attached; left out: body 'chair'; move the rest of the part into that body",
          "robot 'robot': 1 actuator(s) of " + room +
              " refer to elements that are not attached and are left out: m2"));
  EXPECT_THAT(scene.compiled()->notes(),
              ElementsAre(HasSubstr("light 'lamp'"),
                          HasSubstr("left out: geom 'ground'; floors are the scene's "
                                    "(add_floor), nothing meets this one")));
  spec.robots[0].config->root_body = "bse";
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "root_body: no body 'bse'. Its bodies: base, chair. Did you mean 'base'?");
}

// Two arms that stand beside each other in one file.
TEST_F(Robots, ExplainMissingJointsOfASecondRoot) {
  const std::string pair = folder.Write(
      "pair", R"(<worldbody><body name="left"><joint name="l1"/><geom size="0.1"/></body>
      <body name="right"><joint name="r1"/><geom size="0.1"/></body></worldbody>
      <actuator><motor name="m1" joint="l1"/><motor name="m2" joint="r1"/></actuator>)");
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = RobotConfig{.name = "pair",
                                               .model = pair,
                                               .root_body = "left",
                                               .move_groups = {{"left", {.joints = {"l1"}}},
                                                               {"right", {.joints = {"r1"}}}}}});
  ExpectThrow<SpecError>(
      [&] { Scene::Build(spec); },
      pair +
          " has r1, but not below the root body: a robot has one, and right is left out. Put "
          "all of them into one body in that file (`robocell init` makes such a file), or make "
          "a robot of each, with its own robot file and root_body");
  spec.robots[0].config->move_groups.at("right").joints = {"r2"};  // in no body
  EXPECT_THAT(ExpectThrow<SpecError>([&] { Scene::Build(spec); }, "no joint 'r2'"),
              Not(HasSubstr("left out. Put")));
}

TEST_F(Robots, RejectAConfigurationAsAModel) {
  SceneSpec spec = EmptyScene();
  const std::string file = (folder.path() / "arm.yaml").string();
  std::ofstream(file) << "name: arm\nmodel: arm.xml\n";
  spec.robots.push_back({.name = "arm", .path = file});
  ExpectThrow<SpecError>(
      [&] { Scene::Build(spec); },
      file +
          " is YAML, and models are MJCF or URDF. If it is a robot's configuration, "
          "it goes into the `config` of a RobotSpec, without a `path`: config: " +
          file + " in YAML, RobotConfig.load('" + file + "') in Python");
}

TEST_F(Robots, CanHaveANestedRootBody) {
  config.root_body = "upper";
  config.move_groups["arm"].joints = {"elbow"};
  config.move_groups["arm"].actuators = {"servo2"};
  const Scene scene = BuildArm();
  EXPECT_EQ(scene.compiled()->robot("left").root_body, "l_upper");
  EXPECT_GE(FindId(scene.model(), mjOBJ_BODY, "l_base"), 0);
}

TEST_F(Robots, ReportAllProblemsTogether) {
  config.move_groups["arm"].joints = {"shoulder", "elbo"};
  config.move_groups["arm"].actuators = {"servo2", "servo3"};
  config.move_groups["arm"].leaf = ElementRef{.kind = ElementKind::kSite, .name = "flagne"};
  config.collision_geoms = {ElementRef{.kind = ElementKind::kGeom, .body = "fore", .index = 3}};
  config.home["arm"] = {2.5, 0};
  const std::string message =
      ExpectThrow<SpecError>([&] { BuildArm(); }, "scene 'test' has 6 problems:");
  EXPECT_THAT(
      message,
      HasSubstr(
          "\n  robot 'left': no joint 'elbo'. Its joints: shoulder, elbow. Did you mean 'elbow'?"));
  EXPECT_THAT(message,
              HasSubstr("\n  robot 'left': no actuator 'servo3'. Its actuators: servo1, servo2."));
  EXPECT_THAT(message, HasSubstr("\n  robot 'left': move_groups.arm.leaf: no site 'flagne'. Its "
                                 "sites: flange. Did you mean 'flange'?"));
  EXPECT_THAT(message, HasSubstr("\n  robot 'left': move_groups.arm: actuator 'servo2' drives "
                                 "joint 'elbow', but is listed for joint 'shoulder'"));
  EXPECT_THAT(message, HasSubstr("\n  robot 'left': collision_geoms: body 'fore' has 1 geom(s), so "
                                 "there is none with index 3 (they count from 0)"));
  EXPECT_THAT(
      message,
      HasSubstr(
          "\n  robot 'left': home.arm: 2.5 is outside the limits -2 to 2 of joint 'shoulder'"));
}

TEST_F(Robots, ReportDegreesInHome) {
  config.home["arm"] = {90, 0};
  ExpectThrow<SpecError>([&] { BuildArm(); },
                         "home.arm: 90 is outside the limits -2 to 2 of joint 'shoulder'; radians, "
                         "and 90 degrees are 1.5708");
}

TEST_F(Robots, OneProblemIsOneLine) {
  config.move_groups["arm"].joints = {"shoulder", "elbo"};
  ExpectThrow<SpecError>([&] { BuildArm(); },
                         "scene 'test' / robot 'left': no joint 'elbo'. Its joints: shoulder, "
                         "elbow. Did you mean 'elbow'?");
}

TEST_F(Robots, CheckTheirGrippers) {
  config.attachments.push_back({.mjcf_path = gripper, .attach_to = Site("flange"), .prefix = "g_"});
  config.move_groups["gripper"] = {.kind = MoveGroupKind::kGripper,
                                   .joints = {"g_left_slide", "g_right_slide"},
                                   .actuators = {"g_grip"},
                                   .fingers = {{.name = "g_left_pad"}, {.name = "g_rigth_pad"}},
                                   .ctrl = GripperCtrl{.open = 255, .closed = -1}};
  const std::string message = ExpectThrow<SpecError>(
      [&] { BuildArm(); }, "move_groups.gripper.fingers: no geom or body or site 'g_rigth_pad'.");
  EXPECT_THAT(message, HasSubstr("Did you mean 'g_right_pad'?"));
  EXPECT_THAT(
      message,
      HasSubstr("move_groups.gripper.ctrl: -1 is outside the range 0 to 255 of actuator 'g_grip'"));
}

TEST_F(Robots, NameAMissingModel) {
  config.model = "menagerie:unitree_z9/z9.xml";
  ExpectThrow<NotFoundError>(
      [&] { BuildArm(); }, "scene 'test' / robot 'left': menagerie robot 'unitree_z9' not found.");
}

TEST_F(Robots, ReportEngineErrors) {
  config.model = folder.Write(
      "broken", R"(<worldbody><body name="base"><geom type="ball"/></body></worldbody>)");
  ExpectThrow<SpecError>([&] { BuildArm(); },
                         "scene 'test' / robot 'left': " + config.model + ":1: <");
}

TEST(MenagerieRobots, KeepAllActuatorsAndNamesWhenAGripperIsMounted) {
  REQUIRE_MENAGERIE("ufactory_xarm7", "kinova_gen3", "robotiq_2f85");
  SceneSpec spec = EmptyScene();
  spec.robots = {Gen3With2F85("k_"), XArm7With2F85("x_")};
  spec.robots.push_back({.config = XArm7Config(), .prefix = "t_"});
  spec.robots[1].pos = {0, 1, 0};
  spec.robots[2].pos = {0, -1, 0};
  Scene scene = Scene::Build(spec);
  EXPECT_EQ(scene.model()->nu, 8 + 8 + 8 + 3 * 7) << "and motors of the arms";
  EXPECT_EQ(scene.model()->njnt, (7 + 8) + (7 + 8) + 13);
  EXPECT_EQ(scene.model()->nexclude, 6 + 6 + 3 + 3) << "and the first joint of each";
  EXPECT_THAT(scene.camera_names(), ElementsAre("k_wrist", "t_exo_camera", "t_wrist_camera"));
  EXPECT_THAT(scene.compiled()->warnings(), IsEmpty());
  const StepResult result = scene.StepN(300);
  EXPECT_TRUE(result.ok()) << result.message;
}

}  // namespace
}  // namespace robocell::internal
