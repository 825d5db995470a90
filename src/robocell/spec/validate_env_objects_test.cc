#include "robocell/spec/validate_env_objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/env_config.h"
#include "robocell/spec/testing/duo_env.h"
#include "robocell/spec/testing/messages.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ParseError;
using testing::ValidationError;

TEST(EnvObjects, AnObjectStandsInOneFrame) {
  EnvConfig env = Duo();
  env.world_frame_objects["cube"] = Thing();
  env.root_frame_objects["cube"] = Thing();
  EXPECT_EQ(Message(env),
            "it is not valid: root_frame_objects.cube: is in world_frame_objects too; keep one of "
            "them (world_frame_objects stay in the room, root_frame_objects move with the rig, "
            "robot_frame_objects follow a robot's wrist)");
}

TEST(EnvObjects, WhatFollowsAWristIsNoObjectOfTheRoom) {
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

TEST(EnvObjects, ObjectsAreNotNamedLikePartsOfRobots) {
  EnvConfig env = Duo();
  env.root_frame_objects["robotleft"] = Thing();
  EXPECT_THAT(Message(env), HasSubstr("names of its elements would begin with 'robotleft_', as "
                                      "those of robot 'left' do; choose another id"));
}

}  // namespace
}  // namespace robocell::internal
