#include "robocell/spec/env_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "robocell/base/units.h"
#include "robocell/spec/testing/duo_env.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ParseError;
using testing::ValidationError;

TEST(EnvConfig, AcceptsAValidConfiguration) { EXPECT_EQ(Message(Duo()), ""); }

TEST(EnvConfig, LimitsTheFieldOfViewToHalfATurn) {
  EXPECT_THAT(ValidationError(CameraAdderConfig{.fovy = 200}),
              ::testing::HasSubstr("fovy: 200 degrees is not below 180"));
}

TEST(EnvConfig, NeedsARobot) {
  EXPECT_EQ(Message(EnvConfig{}),
            "it is not valid: robots: an environment needs a robot, for example {robot: "
            "xarm7.yaml}");
}

TEST(EnvConfig, KeysAreRobots) {
  EnvConfig env = Duo();
  env.robot_to_shared_base_frame["lft"] = Pose();
  env.gripper_offsets["rigth"] = Pose();
  env.robot_frame_objects["middle"]["mount"] = Thing();
  const std::string message = Message(env);
  EXPECT_THAT(message, HasSubstr("robot_to_shared_base_frame.lft: no robot 'lft'. Known robots: "
                                 "left, right. Did you mean 'left'?"));
  EXPECT_THAT(message, HasSubstr("gripper_offsets.rigth: no robot 'rigth'. Known robots: left, "
                                 "right. Did you mean 'right'?"));
  EXPECT_THAT(message, HasSubstr("robot_frame_objects.middle: no robot 'middle'."));
}

TEST(EnvConfig, RejectsRobotsAtOnePlace) {
  EnvConfig env = Duo();
  env.robot_to_shared_base_frame = {};
  EXPECT_EQ(Message(env),
            "it is not valid: robot_to_shared_base_frame: robots 'left' and 'right' stand at the "
            "same place; give each its pose in the shared base frame");
}

TEST(EnvConfig, RejectsPosesOfRobotsInACombinedModel) {
  EnvConfig env = Duo();
  env.alternative_combined_robot_mjcf = "duo.xml";
  EXPECT_EQ(Message(env),
            "it is not valid: robot_to_shared_base_frame: the robots stand where "
            "alternative_combined_robot_mjcf has them; leave one of the two out");
  env.robot_to_shared_base_frame = {};
  EXPECT_EQ(Message(env), "");
}

TEST(EnvConfig, AMountedGripperNeedsASite) {
  EnvConfig env = Duo();
  env.robots["left"].attachment_site.reset();
  EXPECT_EQ(Message(env),
            "it is not valid: robots.left.attachment_site: is not set, but its gripper is mounted "
            "there; name the site of the robot's model that tools go to");
}

TEST(EnvConfig, GrippersHaveNoArm) {
  EnvConfig env = Duo();
  env.grippers["left"] = Arm();
  EXPECT_THAT(Message(env), HasSubstr("grippers.left.move_groups: a gripper's configuration has a "
                                      "group of kind gripper and none of kind arm"));
}

TEST(EnvConfig, KeepsTheGripperOfTheRobot) {
  EnvConfig env = Duo();
  EXPECT_TRUE(env.has_mounted_gripper("left"));
  env.robots["left"].move_groups["gripper"] = Hand().move_groups["gripper"];
  EXPECT_FALSE(env.has_mounted_gripper("left"));
  EXPECT_EQ(Message(env), "");
  env.gripper_offsets["left"] = Pose();
  EXPECT_EQ(Message(env),
            "it is not valid: gripper_offsets.left: the robot already has a gripper, which stays");
}

TEST(EnvConfig, StepLimitsMatchTheControlMode) {
  EnvConfig env = Duo();
  env.max_relative_movement = {0.1, 0.2};
  EXPECT_EQ(Message(env),
            "it is not valid: max_relative_movement: with control_mode joints it is one number, "
            "radians (metres for slides); found 2 numbers");
  env.control_mode = ControlMode::kCartesianTquat;
  EXPECT_EQ(Message(env), "");
  EXPECT_EQ(env.step_limit().translation, 0.1);
  EXPECT_EQ(env.step_limit().rotation, 0.2);
  env.max_relative_movement = {0.1};
  EXPECT_THAT(Message(env), HasSubstr("with control_mode cartesian_tquat it is two numbers, "
                                      "[metres, radians]; found 1 number"));
  env.max_relative_movement = {0.1, -1};
  EXPECT_THAT(Message(env), HasSubstr("max_relative_movement[1]: "));
}

TEST(EnvConfig, AbsoluteActionsAreUnlimitedByDefault) {
  EnvConfig env;
  EXPECT_DOUBLE_EQ(env.step_limit().rotation, 5 * internal::kPi / 180);
  env.control_mode = ControlMode::kCartesianTrpy;
  EXPECT_EQ(env.step_limit().translation, 0.5);
  EXPECT_DOUBLE_EQ(env.step_limit().rotation, internal::kPi / 2);
  env.relative_to = RelativeTo::kNone;
  EXPECT_TRUE(std::isinf(env.step_limit().translation));
}

TEST(EnvConfig, RejectsReservedRobotNames) {
  for (const std::string taken : {"features", "frames", "objects", "task"}) {
    EnvConfig env = Duo();
    env.robots[taken] = Arm();
    EXPECT_THAT(Message(env), HasSubstr("robots: '" + taken +
                                        "' is a part of observations; give the robot another "
                                        "name"));
  }
}

TEST(EnvConfig, RejectsStepsShorterThanTheTimestep) {
  EnvConfig env = Duo();
  env.sim.frequency = 1000;
  EXPECT_EQ(Message(env), "") << "steps that end when the robots have arrived have none";
  env.sim.async_control = true;
  EXPECT_EQ(Message(env),
            "it is not valid: sim.frequency: 1000 Hz is more often than the engine steps, every "
            "0.002 s; at most 500 Hz");
}

TEST(EnvConfig, RejectsLimitsInMillimetresOrDegrees) {
  EnvConfig env = Duo();
  env.control_mode = ControlMode::kCartesianTquat;
  env.max_relative_movement = {0.05, 1.5};
  EXPECT_EQ(Message(env), "");
  env.max_relative_movement = {50, 1.5};
  EXPECT_EQ(Message(env),
            "it is not valid: max_relative_movement: 50 m is too much for the way of a "
            "step: the numbers are in [metres, radians]");
  env.max_relative_movement = {0.05, 90};
  EXPECT_EQ(Message(env),
            "it is not valid: max_relative_movement: 90 rad is too much for the turn "
            "of a step: the numbers are in [metres, radians]");
  env.control_mode = ControlMode::kJoints;
  env.max_relative_movement = {90};
  EXPECT_EQ(Message(env),
            "it is not valid: max_relative_movement: 90 rad is too much for the step "
            "of a joint: the numbers are in radians (metres for slides)");
}

TEST(EnvConfig, AnAddedCameraNeedsAStream) {
  EnvConfig env = Duo();
  env.camera_adds["wrist"] = {.robot_name = "left"};
  EXPECT_EQ(Message(env),
            "it is not valid: camera_adds.wrist: no stream takes images of this camera; add {name: "
            "wrist, camera: wrist} to cameras.streams, or leave the camera out");
  env.cameras.streams.push_back({.name = "hand", .camera = "wirst"});
  EXPECT_EQ(Message(env),
            "it is not valid: camera_adds.wrist: no stream takes images of this camera, and stream "
            "'hand' takes images of 'wirst'. Did you mean 'wrist'?");
  env.cameras.streams.clear();
  env.camera_adds["wrist"].xml_path = "housing.xml";
  EXPECT_EQ(Message(env), "") << "its housing is something without images too";
  env.camera_adds["wrist"].xml_path = "";
  env.cameras.streams.push_back({.name = "hand", .camera = "wrist"});
  EXPECT_EQ(Message(env), "");
}

TEST(EnvConfig, ExplainsTheFrameOfACameraOffset) {
  EnvConfig env = Duo();
  env.cameras.streams.push_back({.name = "eye", .camera = "eye"});
  env.camera_adds["eye"] = {.attachment_site = "flange"};
  EXPECT_EQ(Message(env),
            "it is not valid: camera_adds.eye.attachment_site: is a site of a robot, but without "
            "robot_name the offset is in the root frame; set robot_name, or leave the site out");
  env.camera_adds["eye"] = {.robot_name = "lefd"};
  EXPECT_THAT(Message(env),
              HasSubstr("camera_adds.eye.robot_name: no robot 'lefd'. Known robots: left, right. "
                        "Did you mean 'left'? Unset, the camera belongs to the rig, and its offset "
                        "is in the root frame"));
}

TEST(EnvConfig, APrimitiveIsAnObjectWithoutAFile) {
  EnvConfig env = Duo();
  env.root_frame_objects["ball"] = {.shape = Shape::kSphere, .size = Vec3{0.03, 0, 0}, .mass = 0.1};
  EXPECT_EQ(Message(env), "");
  env.root_frame_objects["ball"].mass.reset();
  EXPECT_EQ(Message(env),
            "it is not valid: root_frame_objects.ball.mass: a primitive needs its mass in kg");
  env.root_frame_objects["ball"] = {.mjcf_path = "ball.xml", .mass = 0.1};
  EXPECT_EQ(Message(env),
            "it is not valid: root_frame_objects.ball: size, mass, rgba and friction describe a "
            "primitive; name its `shape`");
  env.root_frame_objects["ball"] = {.mjcf_path = "ball.xml", .shape = Shape::kSphere};
  EXPECT_THAT(Message(env), HasSubstr("has both a shape and an mjcf_path; keep one of them"));
}

TEST(EnvConfig, VariationsNeedExistingObjects) {
  EnvConfig env = Duo();
  env.world_frame_objects["cube"] = Thing();
  env.variations["cube"] = {.mass = {2, 1}};
  EXPECT_EQ(Message(env),
            "it is not valid: variations.cube.mass: is [least, largest] factor; the least is above "
            "the largest");
  env.variations["cube"].mass = {1, 2};
  env.variations["cub"] = {};
  EXPECT_EQ(Message(env),
            "it is not valid: variations.cub: no object 'cub'. Known objects: cube. Did you mean "
            "'cube'?");
}

TEST(EnvConfig, RejectsMassVariationsOfFixedObjects) {
  EnvConfig env = Duo();
  env.world_frame_objects["cube"] = Thing();
  env.variations["cube"] = {.mass = {1, 2}};
  EXPECT_EQ(Message(env), "");
  env.world_frame_objects["cube"].fixed = true;
  EXPECT_THAT(Message(env), HasSubstr("variations.cube.mass: changes nothing of an object that is "
                                      "`fixed: true`"));
  env.variations["cube"] = {.friction = {1, 2}, .colour = 0.1};
  EXPECT_EQ(Message(env), "");
}

TEST(EnvConfig, ReportsASingleNumberWithoutAnIndex) {
  EnvConfig env = Duo();
  env.control_mode = ControlMode::kJoints;
  env.max_target_lead = {-0.5};
  EXPECT_EQ(Message(env), "it is not valid: max_target_lead: -0.5 must be greater than 0");
  env.control_mode = ControlMode::kCartesianTquat;
  env.max_target_lead = {0.1, -0.5};
  EXPECT_EQ(Message(env), "it is not valid: max_target_lead[1]: -0.5 must be greater than 0");
}

// Farther than half a turn, less the next action, a rotation has no direction.
TEST(EnvConfig, ALeadOfRotationsStaysBelowHalfATurn) {
  EnvConfig env = Duo();
  env.control_mode = ControlMode::kCartesianTquat;
  for (const double lead : {0.1, 1.5, 2.9, 3.5, 1e9}) {
    env.max_target_lead = {100, lead};
    EXPECT_EQ(env.target_lead().translation, 100);
    EXPECT_EQ(env.target_lead().rotation, std::min(lead, internal::kPi / 2));
    env.max_relative_movement = {0.05, 0.5};
    EXPECT_EQ(env.target_lead().rotation, std::min(lead, internal::kPi - 0.5));
    env.max_relative_movement = {};
  }
  env.control_mode = ControlMode::kJoints;
  env.max_target_lead = {10};
  EXPECT_EQ(env.target_lead().rotation, 10);
}

TEST(EnvConfig, ReportsANonNumericTimestepOnce) {
  try {
    FromYamlUnchecked<SimSettings>("{timestep: 1/0, frequency: 30}");
    FAIL() << "it was read";
  } catch (const SpecError& error) {
    EXPECT_THAT(error.what(), HasSubstr("timestep: expected a number, found '1/0'"));
    EXPECT_THAT(error.what(), Not(HasSubstr("frequency")));
  }
}

TEST(EnvConfig, IsReadFromAFileWithItsRobots) {
  TempDir folder;
  std::filesystem::create_directory(folder.path() / "robots");
  std::ofstream(folder.path() / "robots" / "arm.yaml")
      << "name: arm\nmodel: arm.xml\nattachment_site: flange\n";
  std::ofstream(folder.path() / "env.yaml")
      << "robots: {robot: robots/arm.yaml}\n"
         "robot_frame_objects: {robot: {mount: {mjcf_path: mount.xml, offset: {pos: [0, 0, 1]}}}}\n"
         "sim: {timestep: 0.001}\n";
  const EnvConfig env = EnvConfig::Load(folder.path() / "env.yaml");
  EXPECT_EQ(env.source_dir, folder.path());
  EXPECT_EQ(env.robots.at("robot").source_dir, folder.path() / "robots");
  EXPECT_EQ(env.robot_frame_objects.at("robot").at("mount").offset, Pose(Eigen::Vector3d(0, 0, 1)));
  EXPECT_EQ(env.sim.timestep, 0.001);
}

TEST(EnvConfig, ReportsProblemsWithTheirPlaceInTheFile) {
  EXPECT_EQ(ParseError<EnvConfig>("robots: {robot: {name: a, model: b, attachment_site: s}}\n"
                                  "robot_frame_objects:\n"
                                  "  robt: {mount: {mjcf_path: m.xml}}\n"),
            "f.yaml is not valid: f.yaml:3:9: robot_frame_objects.robt: no robot 'robt'. Known "
            "robots: robot. Did you mean 'robot'?");
  EXPECT_THAT(
      ParseError<EnvConfig>("robots: {robot: {name: a, model: b}}\n"
                            "world_frame_objects: {cube: {offset: {pos: [0, 0, 1]}}}\n"),
      HasSubstr("world_frame_objects.cube.mjcf_path: is required: the object's model file, or "
                "`shape` for a primitive"));
}

TEST(EnvObjects, RejectAnObjectInTwoFrames) {
  EnvConfig env = Duo();
  env.world_frame_objects["cube"] = Thing();
  env.root_frame_objects["cube"] = Thing();
  EXPECT_EQ(Message(env),
            "it is not valid: root_frame_objects.cube: is in world_frame_objects too; keep one of "
            "them (world_frame_objects stay in the room, root_frame_objects move with the rig, "
            "robot_frame_objects follow a robot's wrist)");
}

TEST(EnvObjects, RejectWristObjectsAmongWorldObjects) {
  EnvConfig env = Duo();
  env.world_frame_objects["left"] = Thing();
  EXPECT_THAT(Message(env),
              HasSubstr("world_frame_objects.left: is the name of a robot. What follows its wrist "
                        "goes into robot_frame_objects: {left: {id: ...}}"));
}

TEST(EnvObjects, ObjectsByRobotFollowWrists) {
  EXPECT_THAT(
      ParseError<EnvConfig>("robots: {left: {name: a, model: b, attachment_site: s}}\n"
                            "world_frame_objects: {left: {mount: {mjcf_path: mount.xml}}}\n"),
      HasSubstr(
          "f.yaml:2:30: world_frame_objects.left.mount: objects by name stand where one object "
          "is expected; those that follow a robot's wrist go into robot_frame_objects: "
          "{robot: {id: ...}}, all others are {id: ...} without a robot"));
}

TEST(EnvObjects, RejectNamesOfRobotParts) {
  EnvConfig env = Duo();
  env.root_frame_objects["robotleft"] = Thing();
  EXPECT_THAT(Message(env), HasSubstr("names of its elements would begin with 'robotleft_', as "
                                      "those of robot 'left' do; choose another id"));
}

}  // namespace
}  // namespace robocell
