#include "robocell/env/env_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

constexpr double kExact = 1e-9;

#define EXPECT_POSE(actual, expected)                                                      \
  EXPECT_TRUE((actual).is_close((expected), kExact, kExact)) << (actual) << "\nexpected\n" \
                                                             << (expected)

Pose At(double x, double y, double z) { return Pose(Eigen::Vector3d(x, y, z)); }

Scene BuildEnvScene(const EnvConfig& config) { return Scene::Build(EnvSceneSpec(config)); }

TEST(EnvScene, ASingleRobotWithoutOffsetsStandsInTheWorldsOrigin) {
  TwoArmFolder folder;
  EnvConfig config;
  config.robots["robot"] = folder.arm();
  const Scene scene = BuildEnvScene(config);
  EXPECT_EQ(scene.root_frame_to_world(), Pose());
  EXPECT_EQ(scene.shared_base_frame_to_world(), Pose());
  EXPECT_POSE(scene.body_pose("robotrobot_base"), Pose());
  EXPECT_POSE(Robot::Of(scene, "robot").base_in_world(), Pose());
}

TEST(EnvScene, RobotsStandAtTheProductOfTheThreeTransforms) {
  TwoArmFolder folder;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng = Rng::Stream(seed, "env rig");
    const EnvConfig config = folder.RandomDuo(rng);
    const Scene scene = BuildEnvScene(config);
    for (const char* robot : {"left", "right"}) {
      EXPECT_POSE(Robot::Of(scene, robot).base_in_world(),
                  config.root_frame_to_world * config.shared_base_frame_to_root_frame *
                      *config.robot_to_shared_base_frame.find(robot));
    }
  }
}

// The whole cell: two arms with grippers, an object in each frame, a camera in each.
EnvConfig WholeCell(const TwoArmFolder& folder) {
  EnvConfig config = folder.Duo();
  config.gripper_offsets["left"] = Pose::FromRpy({0.01, 0.02, 0.03}, {0.4, 0, 0.2});
  config.world_frame_objects["lamp"] = {.mjcf_path = folder.box(), .offset = At(1, 0, 2)};
  config.root_frame_objects["mount"] = {.mjcf_path = folder.box(), .offset = At(0, 0, 0.2)};
  config.robot_frame_objects["left"]["bracket"] = {.mjcf_path = folder.box(),
                                                   .offset = At(0, 0.1, 0)};
  config.camera_adds["bird_eye"] = {.offset = Pose::FromRpy({0.3, 0, 2}, {0, 0.1, 0})};
  config.camera_adds["wrist"] = {.offset = At(0.05, 0, 0), .robot_name = "left"};
  for (const std::string& camera : config.camera_adds.keys())
    config.cameras.streams.push_back({.name = camera, .camera = camera});
  return config;
}

TEST(EnvScene, ThingsStandInTheFrameOfTheirDictionary) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  config.root_frame_to_world = Pose::FromRpy({1, 2, 3}, {0.3, 0.2, 0.1});
  const Scene scene = BuildEnvScene(config);
  const Pose wrist = scene.site_pose("robotleft_flange"), root = config.root_frame_to_world;
  EXPECT_POSE(scene.body_pose("lamp_box"), At(1, 0, 2));
  EXPECT_POSE(scene.body_pose("mount_box"), root * At(0, 0, 0.2));
  EXPECT_POSE(scene.body_pose("bracket_box"), wrist * At(0, 0.1, 0));
  EXPECT_POSE(scene.body_pose("gripperleft_palm"), wrist * *config.gripper_offsets.find("left"));
  EXPECT_POSE(scene.body_pose("gripperright_palm"), scene.site_pose("robotright_flange"));
  EXPECT_POSE(scene.camera_pose("bird_eye"), root * Pose::FromRpy({0.3, 0, 2}, {0, 0.1, 0}));
  EXPECT_POSE(scene.camera_pose("wrist"), wrist * At(0.05, 0, 0));
}

TEST(EnvScene, MovingTheRootMovesTheRigRigidlyAndNothingElse) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  const Scene before = BuildEnvScene(config);
  const Pose move = Pose::FromRpy({0.4, -0.3, 0.2}, {0.5, -0.4, 2});
  config.root_frame_to_world = move * config.root_frame_to_world;
  const Scene after = BuildEnvScene(config);
  ASSERT_EQ(after.body_names(), before.body_names());
  for (const std::string& body : before.body_names()) {
    const bool of_room = body == "world" || body == "lamp_box";
    EXPECT_POSE(after.body_pose(body), (of_room ? Pose() : move) * before.body_pose(body)) << body;
  }
  for (const std::string& camera : before.camera_names())
    EXPECT_POSE(after.camera_pose(camera), move * before.camera_pose(camera));
}

TEST(EnvScene, WhatARobotCarriesFollowsItsWristOnly) {
  TwoArmFolder folder;
  const Scene scene = BuildEnvScene(WholeCell(folder));
  const Pose carried =
      scene.site_pose("robotleft_flange").inverse() * scene.body_pose("bracket_box");
  const Pose other = scene.body_pose("gripperright_palm"), mount = scene.body_pose("mount_box");
  Robot::Of(scene, "left").SetJointPos(std::vector<double>{0.7, -1.1});
  EXPECT_POSE(scene.body_pose("bracket_box"), scene.site_pose("robotleft_flange") * carried);
  EXPECT_POSE(scene.body_pose("gripperright_palm"), other);
  EXPECT_POSE(scene.body_pose("mount_box"), mount);
}

TEST(EnvScene, GrippersAreRobotsOfTheirOwn) {
  TwoArmFolder folder;
  const Scene scene = BuildEnvScene(folder.Duo());
  EXPECT_TRUE(Robot::Of(scene, "gripperleft").has_gripper());
  EXPECT_FALSE(Robot::Of(scene, "left").has_gripper());
  EXPECT_TRUE(scene.has_actuator("gripperleft_grip"));
  EXPECT_EQ(MountedGripperName("left"), "gripperleft");
}

TEST(EnvScene, GravityCompensationIsForRobotsAndGrippers) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  for (const bool add : {false, true}) {
    config.add_gravcomp = add;
    const Scene scene = BuildEnvScene(config);
    for (const std::string& body : scene.body_names()) {
      const bool of_robot = body.starts_with("robot") || body.starts_with("gripper");
      EXPECT_EQ(scene.model()->body_gravcomp[FindId(scene.model(), mjOBJ_BODY, body)],
                add && of_robot ? 1 : 0)
          << body;
    }
  }
}

TEST(EnvScene, CamerasHaveTheirLens) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  config.camera_adds["wrist"].fovy = 42;
  const Scene scene = BuildEnvScene(config);
  const auto fovy = [&](const char* camera) {
    return scene.model()->cam_fovy[FindId(scene.model(), mjOBJ_CAMERA, camera)];
  };
  EXPECT_EQ(fovy("wrist"), 42);
  EXPECT_EQ(fovy("bird_eye"), 60);
}

TEST(EnvScene, ACameraSitsInItsHousingAtAnotherSiteToo) {
  TwoArmFolder folder;
  EnvConfig config = WholeCell(folder);
  config.camera_adds["wrist"] = {.xml_path = folder.housing(),
                                 .offset = At(0, 0, 0.1),
                                 .robot_name = "right",
                                 .attachment_site = "flange"};
  const Scene scene = BuildEnvScene(config);
  const Pose shell = scene.site_pose("robotright_flange") * At(0, 0, 0.1);
  EXPECT_POSE(scene.body_pose("wrist_shell"), shell);
  EXPECT_POSE(scene.camera_pose("wrist"), shell * At(0, 0, 0.02));
  EXPECT_THAT(scene.camera_names(), ::testing::UnorderedElementsAre("bird_eye", "wrist"));
}

TEST(EnvScene, RefusesWhatIsNotValidByTheEnvironmentsName) {
  ExpectThrow<SpecError>([] { EnvSceneSpec({.name = "duo"}); },
                         "environment 'duo' is not valid: robots: an environment needs a robot");
}

TEST(EnvScene, ALooseObjectIsNotCarriedByARobot) {
  TwoArmFolder folder;
  EnvConfig config = folder.Duo();
  config.robot_frame_objects["left"]["tool"] = {.mjcf_path = folder.box(), .fixed = false};
  ExpectThrow<SpecError>([&] { BuildEnvScene(config); },
                         "object 'tool': can move freely, so it cannot be attached to the "
                         "attachment site of robot 'left'; attach it to the world, or set fixed: "
                         "true");
}

}  // namespace
}  // namespace robocell
