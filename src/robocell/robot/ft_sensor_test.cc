// Tests force-torque sensors of robots: a hanging mass reads its weight in any orientation, sensors
// belong to their robots, and pairs that are not a sensor give errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/math/rotation.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

constexpr double kGravity = 9.81;
constexpr double kMass = 0.8;
const Eigen::Vector3d kCentre(0.03, -0.02, 0.1);  // of the mass, in the sensor's site
const Eigen::Vector3d kWeight(0, 0, -kMass* kGravity);

double FtError(const Wrench& a, const Wrench& b) { return (a - b).vector().cwiseAbs().maxCoeff(); }

// A sensor in any orientation, with a mass hung on its plate.
class FtSensorTest : public ::testing::Test {
 protected:
  FtSensorTest() {
    config.name = "probe";
    config.model = "ft_sensor";
    config.root_body = "ft_sensor";
    config.base.kind = BaseKind::kMocap;
    config.attachments.push_back(
        {.mjcf_path = weight, .attach_to = Site("wrist_ft_site"), .prefix = "w_"});
    config.ft_sensors = {{.name = "wrist_ft", .frame_site = "wrist_ft_site"}};
  }
  Robot Make() const { return RobotAlone(config); }
  static void Turn(Robot& robot, const Pose& base) {
    robot.base().SetPose(base);
    robot.scene().Forward();
    robot.Update();
  }
  std::string Refused() const {
    try {
      Make();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  ModelFolder folder;
  std::string weight = folder.Write("weight", R"(<worldbody><body name="mass">
      <geom name="lump" size="0.02" pos="0.03 -0.02 0.1" mass="0.8"/>
      <site name="end" pos="0.05 0.02 0.2" euler="30 -40 70"/></body></worldbody>)");
  RobotConfig config;
};

TEST_F(FtSensorTest, AHangingMassReadsItsWeightInEveryOrientation) {
  Robot robot = Make();
  Rng rng = Rng::Stream(1, "ft orientations");
  for (int i = 0; i < 200; ++i) {
    Turn(robot, Pose(Eigen::Vector3d(0.2, -0.1, 1), RandomQuaternion(rng)));
    const Pose site = robot.ft_sensor_frame("wrist_ft");
    EXPECT_TRUE(site.is_close(robot.scene().site_pose("wrist_ft_site"), 1e-12, 1e-12));
    const Eigen::Vector3d weight_in_site = site.rotation().transpose() * kWeight;
    const Wrench expected{.force = weight_in_site, .torque = kCentre.cross(weight_in_site)};
    EXPECT_LT(FtError(robot.ft_sensor("wrist_ft"), expected), 1e-4 * kWeight.norm()) << i;
  }
}

TEST_F(FtSensorTest, AnUprightSensorReadsADownwardLoad) {
  Robot robot = Make();
  Turn(robot, Pose(Eigen::Vector3d(0, 0, 1)));
  EXPECT_NEAR(robot.ft_sensor("wrist_ft").force.z(), -kMass * kGravity, 1e-3);
}

TEST_F(FtSensorTest, AnotherSiteOfTheFrameGivesTheEquivalentWrench) {
  RobotConfig elsewhere = config;
  elsewhere.ft_sensors.push_back({.name = "at_end",
                                  .force_sensor = "wrist_ft_force",
                                  .torque_sensor = "wrist_ft_torque",
                                  .frame_site = "w_end"});
  Robot robot = RobotAlone(elsewhere);
  Rng rng = Rng::Stream(2, "ft frames");
  for (int i = 0; i < 20; ++i) {
    Turn(robot, Pose(Eigen::Vector3d(0, 0, 1), RandomQuaternion(rng)));
    const Pose X_EndSensor =
        robot.ft_sensor_frame("at_end").inverse() * robot.ft_sensor_frame("wrist_ft");
    const Wrench expected = Transformed(X_EndSensor, robot.ft_sensor("wrist_ft"));
    EXPECT_LT(FtError(robot.ft_sensor("at_end"), expected), 1e-9) << i;
  }
}

TEST_F(FtSensorTest, ToolCompensationLeavesOnlyExternalForces) {
  config.ft_sensors[0].compensate_tool = true;
  Robot robot = Make();
  Scene scene = robot.scene();
  Rng rng = Rng::Stream(3, "ft compensation");
  const Eigen::Vector3d push(3, -2, 5);
  for (int i = 0; i < 20; ++i) {
    scene.SetBodyWrench("w_mass", {0, 0, 0}, {0, 0, 0});
    Turn(robot, Pose(Eigen::Vector3d(0, 0, 1), RandomQuaternion(rng)));
    EXPECT_LT(robot.ft_sensor("wrist_ft").vector().norm(), 1e-9) << i;
    scene.SetBodyWrench("w_mass", push, {0, 0, 0});
    scene.Forward();
    robot.Update();
    const Eigen::Vector3d in_site = robot.ft_sensor_frame("wrist_ft").rotation().transpose() * push;
    const Wrench expected{.force = in_site, .torque = kCentre.cross(in_site)};
    EXPECT_LT(FtError(robot.ft_sensor("wrist_ft"), expected), 1e-6) << i;
  }
}

TEST_F(FtSensorTest, ReadsTheToolWeightDespiteGravcomp) {
  config.gravcomp = true;
  Robot robot = Make();
  Turn(robot, Pose(Eigen::Vector3d(0, 0, 1)));
  EXPECT_NEAR(robot.ft_sensor("wrist_ft").force.z(), -kMass * kGravity, 1e-3);
}

TEST_F(FtSensorTest, TareHoldsUntilTheNextReset) {
  Robot robot = Make();
  const Pose there(Eigen::Vector3d(0, 0, 1));
  Turn(robot, there);
  const Wrench before = robot.ft_sensor("wrist_ft");
  robot.TareFtSensor("wrist_ft");
  EXPECT_EQ(robot.ft_sensor("wrist_ft"), Wrench{});
  Turn(robot, there);
  EXPECT_EQ(robot.ft_sensor("wrist_ft"), Wrench{});
  robot.scene().SetBodyWrench("w_mass", {0, 0, -2}, {0, 0, 0});
  Turn(robot, there);
  EXPECT_NEAR(robot.ft_sensor("wrist_ft").force.z(), -2, 1e-9) << "what was added";
  robot.TareFtSensor("wrist_ft");
  Turn(robot, there);
  EXPECT_LT(robot.ft_sensor("wrist_ft").vector().norm(), 1e-9) << "twice is from the first";
  robot.scene().Reset();
  Turn(robot, there);
  EXPECT_LT(FtError(robot.ft_sensor("wrist_ft"), before), 1e-9);
}

TEST_F(FtSensorTest, AResetUpdatesTheReading) {
  Robot robot = Make();
  Scene scene = robot.scene();
  scene.SetBodyWrench("w_mass", {0, 0, -2}, {0, 0, 0});
  Turn(robot, Pose(Eigen::Vector3d(0, 0, 1), Quaternion{1, 0, 0, 0}));
  scene.Reset();
  const Wrench after = robot.ft_sensor("wrist_ft");
  EXPECT_NEAR(after.force.norm(), kMass * kGravity, 1e-3);
  scene.Forward();
  robot.Update();
  EXPECT_LT(FtError(robot.ft_sensor("wrist_ft"), after), 1e-9);
  scene.Reset();
  robot.TareFtSensor("wrist_ft");
  EXPECT_EQ(robot.ft_sensor("wrist_ft"), Wrench{});
  robot.Update();
  EXPECT_LT(robot.ft_sensor("wrist_ft").vector().norm(), 1e-9);
}

TEST_F(FtSensorTest, TareUsesTheCurrentReading) {
  Robot robot = Make();
  Turn(robot, Pose(Eigen::Vector3d(0, 0, 1)));
  robot.scene().SetBodyWrench("w_mass", {0, 0, -2}, {0, 0, 0});
  robot.scene().Forward();
  robot.TareFtSensor("wrist_ft");
  robot.Update();
  EXPECT_LT(robot.ft_sensor("wrist_ft").vector().norm(), 1e-9);
}

TEST_F(FtSensorTest, ContinuesWhenObjectsComeAndGo) {
  Robot robot = Make();
  Scene scene = robot.scene();
  const Pose there(Eigen::Vector3d(0, 0, 1));
  Turn(robot, there);
  robot.TareFtSensor("wrist_ft");
  scene.AddObject(BoxObject("cube", {1, 1, 0.02}));
  scene.SetBodyWrench("w_mass", {0, 0, -2}, {0, 0, 0});
  Turn(robot, there);
  EXPECT_NEAR(robot.ft_sensor("wrist_ft").force.z(), -2, 1e-9) << "still tared";
  scene.RemoveObject("cube");
  Turn(robot, there);
  EXPECT_NEAR(robot.ft_sensor("wrist_ft").force.z(), -2, 1e-9);
}

TEST_F(FtSensorTest, SensorsOfTwoRobotsAreIndependent) {
  SceneSpec spec = EmptyScene();
  RobotConfig other = config;
  other.attachments.clear();
  spec.robots = {{.name = "left", .config = config, .prefix = "l_"},
                 {.name = "right", .config = other, .prefix = "r_"}};
  Scene scene = Scene::Build(spec);
  Robot left = Robot::Of(scene, "left"), right = Robot::Of(scene, "right");
  scene.Forward();
  left.Update();
  right.Update();
  EXPECT_NEAR(left.ft_sensor("wrist_ft").force.norm(), kMass * kGravity, 1e-3);
  EXPECT_NEAR(right.ft_sensor("wrist_ft").force.norm(), 0, 1e-3);
  EXPECT_THAT(left.ft_sensor_names(), ::testing::ElementsAre("wrist_ft"));
  scene.Close();
  ExpectThrow<ClosedError>([&] { left.ft_sensor("wrist_ft"); }, "robot 'left' is closed");
}

TEST_F(FtSensorTest, AnUnknownNameErrorListsTheSensors) {
  const Robot robot = Make();
  ExpectThrow<NotFoundError>(
      [&] { robot.ft_sensor("wrist"); },
      "robot 'probe': no ft sensor 'wrist'. Its ft sensors: wrist_ft. Did you mean 'wrist_ft'?");
  config.ft_sensors.clear();
  const Robot without = Make();
  ExpectThrow<NotFoundError>([&] { without.ft_sensor("wrist_ft"); },
                             "Its ft sensors: (none). List them as `ft_sensors` of its "
                             "configuration or of the ToolFrameSpec");
}

TEST_F(FtSensorTest, RejectsAnInvalidPairAndListsTheSensors) {
  config.ft_sensors[0].name = "wrist";
  EXPECT_EQ(Refused(),
            "scene 'test' / robot 'probe': ft sensor 'wrist': no force sensor 'wrist_force'. Its "
            "force sensors: wrist_ft_force. Did you mean 'wrist_ft_force'? A force-torque sensor "
            "`x` is the pair x_force and x_torque; where they are called otherwise, set "
            "`force_sensor` and `torque_sensor`");
  config.ft_sensors[0] = {.name = "wrist_ft", .torque_sensor = "wrist_ft_force"};
  EXPECT_THAT(Refused(), ::testing::HasSubstr("sensor 'wrist_ft_force' is no torque sensor. Its "
                                              "torque sensors: wrist_ft_torque"));
  config.ft_sensors[0] = {.name = "wrist_ft", .frame_site = "wrist_site"};
  EXPECT_THAT(Refused(), ::testing::HasSubstr("ft sensor 'wrist_ft': frame_site: no site "
                                              "'wrist_site'. Its sites: "));
  config.ft_sensors[0] = {.name = "wrist_ft"};
  config.edits = ParseYaml<RobotConfig>(
                     "{name: a, model: a, edits: [{add_sensor: other_torque, site: w_end, type: "
                     "torque}]}",
                     "a.yaml")
                     .edits;
  config.attachments.clear();
  config.edits[0].site = ElementRef{.name = "wrist_ft_site"};
  config.ft_sensors[0].torque_sensor = "other_torque";
  EXPECT_EQ(Refused(), "") << "at the same site it is a pair";
}

TEST_F(FtSensorTest, RejectsAPairAtTwoSites) {
  config.model = folder.Write("apart", R"(<worldbody><body name="ft_sensor"><geom size="0.02"/>
      <site name="wrist_ft_site"/><site name="beside" pos="0.1 0 0"/></body></worldbody>
      <sensor><force name="wrist_ft_force" site="wrist_ft_site"/>
      <torque name="wrist_ft_torque" site="beside"/></sensor>)");
  EXPECT_THAT(Refused(),
              ::testing::HasSubstr("sensor 'wrist_ft_force' measures at site 'wrist_ft_site', but "
                                   "sensor 'wrist_ft_torque' measures at site 'beside'; the two "
                                   "of a pair measure at one site"));
}

TEST_F(FtSensorTest, ThePrefixSelectsOneOfSeveral) {
  config.attachments[0] = {
      .mjcf_path = "ft_sensor", .attach_to = Site("wrist_ft_site"), .prefix = "a_"};
  config.attachments.push_back(
      {.mjcf_path = "ft_sensor", .attach_to = Site("a_wrist_ft_site"), .prefix = "b_"});
  config.ft_sensors[0] = {.name = "b_wrist_ft"};
  Robot robot = Make();
  Turn(robot, Pose(Eigen::Vector3d(0, 0, 1)));
  EXPECT_NEAR(robot.ft_sensor("b_wrist_ft").force.norm(), 0, 1e-3);
  config.ft_sensors[0] = {.name = "ft"};
  EXPECT_THAT(Refused(),
              ::testing::HasSubstr("no force sensor 'ft_force'. Its force sensors: wrist_ft_force, "
                                   "a_wrist_ft_force, b_wrist_ft_force."));
  EXPECT_THAT(Refused(), ::testing::EndsWith(
                             "Several end so: write `force_sensor` with the attachment's prefix"));
}

TEST_F(FtSensorTest, ErrorsInAFileHaveLineAndColumn) {
  RobotConfig file = ParseYaml<RobotConfig>(
      "name: probe\nmodel: ft_sensor\nft_sensors:\n  - {name: wrist}\n", "probe.yaml");
  ExpectThrow<SpecError>([&] { RobotAlone(file); },
                         "probe.yaml:4:5: robot 'probe': ft sensor 'wrist': no force sensor");
  ExpectThrow<SpecError>(
      [] { ParseYaml<RobotConfig>("{name: a, model: b, ft_sensors: [{name: ''}]}", "a.yaml"); },
      "`wrist_ft` stands for the pair wrist_ft_force and wrist_ft_torque");
  ExpectThrow<SpecError>(
      [] {
        ParseYaml<RobotConfig>("{name: a, model: b, ft_sensors: [{name: f}, {name: f}]}", "a.yaml");
      },
      "sensor 'f' (ft_sensors[1]): name 'f' is also that of ft_sensors[0]; each needs its own");
}

// Returns true if the gripper leans on the arm, so that the sensor does not carry all of its
// weight.
bool GripperLeans(const Scene& scene) {
  const std::vector<Contact> contacts = scene.contacts("base_link");
  return std::any_of(contacts.begin(), contacts.end(), [](const Contact& c) {
    return c.body1.starts_with("g_") != c.body2.starts_with("g_");
  });
}

// The guide's arm: sensor on the arm's site, gripper on the sensor's. Torques hold it against
// gravity, so that only rest is assumed.
TEST(FtSensorOnAnArm, WeighsTheGripperInEveryOrientation) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  RobotSpec arm{.path = "menagerie:kinova_gen3", .pos = {0, 0, 2}};
  arm.attachments = {
      {.mjcf_path = "ft_sensor", .attach_to = Site("pinch_site")},
      {.mjcf_path = "menagerie:robotiq_2f85", .attach_to = Site("wrist_ft_site"), .prefix = "g_"}};
  Scene scene = Scene::Build(SceneWith(arm));
  Robot robot = Robot::FromScene(
      scene, "base_link", "bracelet_link",
      {.tool = {.tool_body = "ft_sensor",
                .tcp_site = "g_pinch",
                .ft_sensors = {{.name = "wrist_ft", .frame_site = "wrist_ft_site"}}}});
  const mjModel* m = scene.model();
  const double weight =
      m->body_subtreemass[RequireId(m, mjOBJ_BODY, "g_base_mount", "test")] * kGravity;
  ASSERT_GT(weight, 5);
  robot.set_ctrl_mode(CtrlMode::kTorque);
  Rng rng = Rng::Stream(4, "ft arm");
  int weighed = 0;
  for (int i = 0; i < 40 && weighed < 12; ++i) {
    scene.Reset();
    std::vector<double> q;
    for (const Interval& limit : robot.joint_limits())
      q.push_back(std::isfinite(limit.lower) ? rng.Uniform(limit.lower, limit.upper)
                                             : rng.Uniform(-M_PI, M_PI));
    robot.SetJointPos(q);
    if (GripperLeans(scene)) continue;
    ++weighed;
    for (int step = 0; step < 300; ++step) {
      robot.Update();
      robot.GravityTorques(robot.jnt_trq_cmd());
      ASSERT_TRUE(robot.Step().ok());
    }
    robot.Update();
    const Eigen::Vector3d load =
        robot.ft_sensor_frame("wrist_ft").rotation() * robot.ft_sensor("wrist_ft").force;
    EXPECT_LT((load - Eigen::Vector3d(0, 0, -weight)).norm(), 0.01 * weight)
        << i << ": " << load.transpose() << " but weighs " << weight;
  }
  EXPECT_EQ(weighed, 12);
}

}  // namespace
}  // namespace robocell
