// Robots: names, prefixes, attachments, overrides, tool points; what is said when they do not fit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <fstream>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Robots : public ::testing::Test {
 protected:
  // A scene with the two-joint arm under this configuration.
  Scene BuildArm() { return Scene::Build(ArmScene()); }
  SceneSpec ArmScene() {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "left", .config = config, .prefix = "l_"});
    return spec;
  }
  double Prm(const Scene& scene, const mjtNum* array, int columns, const char* actuator,
             int column) {
    return array[columns * RequireId(scene.model(), mjOBJ_ACTUATOR, actuator, "") + column];
  }

  ModelFolder folder;
  RobotConfig config = ArmConfig(folder.Write("arm", kTwoJointArm));
  std::string gripper = folder.Write("gripper", kTwoFingerGripper);
};

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

TEST_F(Robots, OfTheSameNameAreRefused) {
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

TEST_F(Robots, CarryToolsOnToolsWithAllTheirElements) {
  config.attachments.push_back({.mjcf_path = gripper,
                                .attach_to = Site("flange"),
                                .prefix = "g_",
                                .pos = {0, 0, 0.02},
                                .contact_exclusions = {{"fore", "g_left"}}});
  const std::string probe = folder.Write(
      "probe",
      R"(<worldbody><body name="needle"><geom size="0.005" pos="0 0 0.02"/></body></worldbody>)");
  SceneSpec spec = ArmScene();
  spec.robots[0].attachments.push_back(
      {.mjcf_path = probe, .attach_to = Body("g_palm"), .prefix = "p_", .euler = {0, 90, 0}});
  const Scene scene = Scene::Build(spec);
  const Pose palm = scene.site_pose("l_flange") * Pose(Eigen::Vector3d(0, 0, 0.03));
  EXPECT_TRUE(scene.body_pose("l_g_palm").is_close(palm, 1e-9, 1e-9));
  EXPECT_TRUE(scene.body_pose("l_p_needle")
                  .is_close(palm * Pose::FromRpy({0, 0, 0}, {0, M_PI / 2, 0}), 1e-9, 1e-9));
  const mjModel* m = scene.model();
  EXPECT_EQ(m->nu, 3 + 2) << "and motors of the arm";
  EXPECT_EQ(m->neq, 1);
  EXPECT_EQ(m->ntendon, 1);
  ASSERT_EQ(m->nexclude, 1);
  EXPECT_EQ(m->exclude_signature[0], (RequireId(m, mjOBJ_BODY, "l_fore", "") << 16) +
                                         RequireId(m, mjOBJ_BODY, "l_g_left", ""));
  EXPECT_THAT(scene.compiled()->warnings(), IsEmpty());
}

TEST_F(Robots, SayWhatToDoAboutAToolWithNamesOfTheirs) {
  const std::string twin = folder.Write(
      "twin", R"(<worldbody><body name="upper"><geom size="0.005"/></body></worldbody>)");
  SceneSpec spec = ArmScene();
  spec.robots[0].attachments.push_back({.mjcf_path = twin, .attach_to = Body("fore")});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / robot 'left' / attachment '" + twin +
                             "': body 'upper' would come from " + twin + " and is in " +
                             config.model +
                             " already; set the attachment's `prefix`, which its names begin with "
                             "then");
}

// The engine refuses meshes and materials when they are attached, joints when it compiles.
constexpr const char* kRing = R"(
  <asset><mesh name="ring" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><material name="red"/></asset>
  <worldbody><body name="{0}base"><geom type="mesh" mesh="ring" material="red"/>
    <body name="{0}tip"><joint name="turn"/><geom name="{0}geom" size="0.1"/></body></body>
    <geom name="floor" size="0.1"/></worldbody>
  <actuator><motor name="{0}push" joint="turn"/></actuator>)";

TEST_F(Robots, TellAllNamesThatAToolHasInCommonWithThem) {
  config = {.name = "arm", .model = folder.Write("ringed", fmt::format(kRing, "a_"))};
  const std::string tool = folder.Write("tool", fmt::format(kRing, "t_"));
  config.attachments.push_back({.mjcf_path = tool, .attach_to = Body("a_tip")});
  ExpectThrow<SpecError>([&] { BuildArm(); },
                         "joint 'turn', mesh 'ring', material 'red' would come from " + tool +
                             " and are in " + config.model + " already; set the attachment's");
  config.attachments[0].prefix = "t_";
  EXPECT_EQ(BuildArm().model()->nmesh, 2);
}

TEST_F(Robots, TellAPrefixThatMakesNamesOfTheirs) {
  const std::string tool = folder.Write(
      "tool", R"(<worldbody><body name="per"><geom size="0.005"/></body></worldbody>)");
  config.attachments.push_back({.mjcf_path = tool, .attach_to = Body("fore"), .prefix = "up"});
  ExpectThrow<SpecError>([&] { BuildArm(); },
                         "body 'upper' would come from " + tool + " and is in " + config.model +
                             " already; give the attachment another `prefix` than 'up'");
}

TEST_F(Robots, CarryChainsOfTools) {
  const std::string link = folder.Write("link", R"(
  <worldbody><body name="bar" pos="0.01 0 0" euler="0 20 30">
    <geom type="capsule" fromto="0 0 0 0 0 0.03" size="0.005"/><site name="tip" pos="0 0 0.03"/>
  </body></worldbody>)");
  const Pose authored = Pose::FromRpy({0.01, 0, 0}, {0, Radians(20), 0}) *
                        Pose::FromRpy({0, 0, 0}, {0, 0, Radians(30)});  // about the turned axes
  SceneSpec spec = ArmScene();
  std::string site = "flange";
  for (int i = 0; i < 5; ++i) {
    const std::string prefix = fmt::format("t{}_", i);
    spec.robots[0].attachments.push_back(
        {.mjcf_path = link, .attach_to = Site(site), .prefix = prefix});
    site = prefix + "tip";
  }
  const Scene scene = Scene::Build(spec);
  Pose expected = scene.site_pose("l_flange");
  for (int i = 0; i < 5; ++i) {
    expected = expected * authored * Pose(Eigen::Vector3d(0, 0, 0.03));
    EXPECT_TRUE(scene.site_pose(fmt::format("l_t{}_tip", i)).is_close(expected, 1e-9, 1e-9)) << i;
  }
}

TEST_F(Robots, SayWhereAToolCannotGo) {
  config.attachments.push_back({.mjcf_path = gripper, .attach_to = Site("flang"), .prefix = "g_"});
  ExpectThrow<NotFoundError>(
      [&] { BuildArm(); },
      "scene 'test' / robot 'left' / attachment 'g_': attach_to: no site 'flang'. "
      "Known sites: flange. Did you mean 'flange'?");
  config.attachments[0].attach_to = Site("flange");
  config.attachments[0].contact_exclusions = {{"fore", "g_leff"}};
  ExpectThrow<NotFoundError>([&] { BuildArm(); },
                             "contact_exclusions: the robot: no body 'g_leff'");
  config.attachments[0].mjcf_path = "griper.xml";
  const std::string message =
      ExpectThrow<NotFoundError>([&] { BuildArm(); },
                                 "scene 'test' / robot 'left' / attachment 'g_': model file "
                                 "'griper.xml' not found. Looked for: ");
  EXPECT_THAT(message, HasSubstr("ROBOCELL_MODEL_PATH"));
  config.attachments[0].prefix = "";
  ExpectThrow<NotFoundError>([&] { BuildArm(); }, "robot 'left' / attachment 'griper.xml': model");
}

TEST_F(Robots, TakeOnlyTheirRootAndSayWhatStaysBehind) {
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
      ElementsAre("robot 'robot': only body 'base' of " + room +
                      " is attached; left out of its world: body 'chair'; what belongs to it goes "
                      "into that body in the file",
                  "robot 'robot': 1 actuator(s) of " + room +
                      " refer to elements that are not attached and are left out: m2"));
  EXPECT_THAT(scene.compiled()->notes(),
              ElementsAre(HasSubstr("light 'lamp'"),
                          HasSubstr("left out of its world: geom 'ground'; floors are the scene's "
                                    "(add_floor), nothing meets this one")));
  spec.robots[0].config->root_body = "bse";
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "root_body: no body 'bse'. Its bodies: base, chair. Did you mean 'base'?");
}

TEST_F(Robots, AConfigurationIsNoModel) {
  SceneSpec spec = EmptyScene();
  const std::string file = (folder.path() / "arm.yaml").string();
  std::ofstream(file) << "name: arm\nmodel: arm.xml\n";
  spec.robots.push_back({.name = "arm", .path = file});
  ExpectThrow<SpecError>(
      [&] { Scene::Build(spec); },
      file +
          " is YAML, and models are MJCF. If it is a robot's configuration, "
          "it goes into the `config` of a RobotSpec, without a `path`: config: " +
          file + " in YAML, RobotConfig.load('" + file + "') in Python");
}

TEST_F(Robots, HaveTheirBaseFrameAtANestedRootBody) {
  config.root_body = "upper";
  config.move_groups["arm"].joints = {"elbow"};
  config.move_groups["arm"].actuators = {"servo2"};
  const Scene scene = BuildArm();
  EXPECT_EQ(scene.compiled()->robot("left").root_body, "l_upper");
  EXPECT_GE(FindId(scene.model(), mjOBJ_BODY, "l_base"), 0);
}

TEST_F(Robots, OverrideGainsLimitsAndGravityOfTheirOwnBodiesOnly) {
  config.gravcomp = true;
  config.stiffness = 321;
  config.damping = 12;
  config.force_limit = 7;
  SceneSpec spec = ArmScene();
  spec.robots.push_back({.path = config.model, .prefix = "other_"});
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  for (const char* name : {"l_servo1", "l_servo2"}) {
    EXPECT_EQ(Prm(scene, m->actuator_gainprm, mjNGAIN, name, 0), 321);
    EXPECT_EQ(Prm(scene, m->actuator_biasprm, mjNBIAS, name, 1), -321);
    EXPECT_EQ(Prm(scene, m->actuator_biasprm, mjNBIAS, name, 2), -12);
    EXPECT_EQ(Prm(scene, m->actuator_forcerange, 2, name, 1), 7);
  }
  EXPECT_EQ(Prm(scene, m->actuator_gainprm, mjNGAIN, "other_servo1", 0), 100);
  EXPECT_EQ(m->body_gravcomp[RequireId(m, mjOBJ_BODY, "l_fore", "")], 1);
  EXPECT_EQ(m->body_gravcomp[RequireId(m, mjOBJ_BODY, "other_fore", "")], 0);
}

TEST_F(Robots, RefuseGainsForWhatIsNoServo) {
  config.model = folder.Write(
      "motors",
      R"(<worldbody><body name="base"><geom size="0.1"/><body><joint name="shoulder" axis="0 0 1"/><geom size="0.1"/></body></body></worldbody>
      <actuator><motor name="servo1" joint="shoulder"/></actuator>)");
  config.move_groups["arm"] = {
      .kind = MoveGroupKind::kArm, .joints = {"shoulder"}, .actuators = {"servo1"}};
  config.stiffness = 10;
  ExpectThrow<SpecError>(
      [&] { BuildArm(); },
      "stiffness, damping and force_limit are for position servos; actuator 'servo1' is none");
}

// The gains of force = gain * ctrl + a + b * length.
TEST_F(Robots, StiffenServosWithScaledControlsWhichRestWhereTheyDid) {
  config.model = folder.Write(
      "scaled",
      R"(<worldbody><body name="base"><geom size="0.1"/><body><joint name="shoulder" axis="0 0 1"/><geom size="0.1"/></body></body></worldbody>
      <actuator><general name="servo1" joint="shoulder" gainprm="0.5" biastype="affine" biasprm="-2 -4 -1"/></actuator>)");
  config.move_groups["arm"] = {.kind = MoveGroupKind::kArm, .joints = {"shoulder"}};
  config.stiffness = 40;
  const Scene scene = BuildArm();
  const mjModel* m = scene.model();
  const int servo = RequireId(m, mjOBJ_ACTUATOR, "l_servo1", "");
  EXPECT_DOUBLE_EQ(m->actuator_gainprm[mjNGAIN * servo], 5);
  EXPECT_DOUBLE_EQ(m->actuator_biasprm[mjNBIAS * servo], -20);
  EXPECT_EQ(m->actuator_biasprm[mjNBIAS * servo + 1], -40);
  EXPECT_EQ(m->actuator_biasprm[mjNBIAS * servo + 2], -1);
}

TEST_F(Robots, GetATcpSiteFromTheOffset) {
  config.move_groups["arm"].leaf.reset();
  config.attachment_site = "flange";
  config.tcp_offset = Pose::FromRpy({0, 0, 0.1}, {0, 0, 1});
  const Scene scene = BuildArm();
  const RobotRecord& robot = scene.compiled()->robot("left");
  EXPECT_EQ(robot.attachment_site, "l_flange");
  ASSERT_EQ(robot.tcp_site, "l_tcp");
  EXPECT_TRUE(scene.site_pose("l_tcp").is_close(scene.site_pose("l_flange") * *config.tcp_offset,
                                                1e-9, 1e-9));
}

TEST_F(Robots, RefuseTwoDifferentToolPoints) {
  config.attachment_site = "flange";
  config.tcp_offset = Pose(Eigen::Vector3d(0, 0, 0.1));
  ExpectThrow<SpecError>(
      [&] { BuildArm(); },
      "scene 'test' / robot 'left': the TCP is given twice: site 'flange' is the arm's leaf, but "
      "attachment_site * tcp_offset is 0.1 m and 0 rad away from it; keep one of them");
  config.tcp_offset = Pose();
  EXPECT_NO_THROW(BuildArm());
}

TEST_F(Robots, NameEverythingThatIsWrongAtOnce) {
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
                                 "joint 'elbow', but stands in the place of joint 'shoulder'"));
  EXPECT_THAT(message, HasSubstr("\n  robot 'left': collision_geoms: body 'fore' has 1 geom(s), so "
                                 "there is none with index 3 (they count from 0)"));
  EXPECT_THAT(
      message,
      HasSubstr(
          "\n  robot 'left': home.arm: 2.5 is outside the limits -2 to 2 of joint 'shoulder'"));
}

TEST_F(Robots, DegreesInHomeAreTold) {
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

TEST_F(Robots, SayWhichModelIsMissing) {
  config.model = "menagerie:unitree_z9/z9.xml";
  ExpectThrow<NotFoundError>(
      [&] { BuildArm(); }, "scene 'test' / robot 'left': menagerie robot 'unitree_z9' not found.");
}

TEST_F(Robots, SayWhatTheEngineDislikes) {
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
}  // namespace robocell
