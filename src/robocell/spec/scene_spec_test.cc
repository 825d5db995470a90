#include "robocell/spec/scene_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/specs.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;
using testing::ValidationError;

SceneSpec Empty() { return {.timestep = 0.002, .add_floor = true, .add_skybox = true}; }

TEST(SceneSpec, WithoutABaseTheWorldMustBeExplicit) {
  EXPECT_EQ(ValidationError(SceneSpec{}, "scene 'scene'"),
            "scene 'scene' is not valid, 3 problems:\n"
            "  timestep: is required without a base scene, for example 0.002 (seconds)\n"
            "  add_floor: is required without a base scene: true or false\n"
            "  add_skybox: is required without a base scene: true or false");
  EXPECT_EQ(ValidationError(SceneSpec{.base = "lab.xml"}), "");
  EXPECT_EQ(ValidationError(Empty()), "");
}

TEST(SceneSpec, TheTimestepIsPositive) {
  SceneSpec spec = Empty();
  spec.timestep = 0;
  EXPECT_EQ(ValidationError(spec), "it is not valid: timestep: 0 must be greater than 0");
}

TEST(SceneSpec, RejectsATimestepInAnotherUnit) {
  SceneSpec spec = Empty();
  spec.timestep = 2;
  EXPECT_EQ(ValidationError(spec),
            "it is not valid: timestep: 2 s is too long for a step of the engine, at most 0.1 s; "
            "0.002 s is usual");
  spec.timestep = 2e-6;
  EXPECT_EQ(ValidationError(spec),
            "it is not valid: timestep: 2e-06 s is too short for a step of the engine, at least "
            "1e-05 s; 0.002 s is usual");
}

TEST(SceneSpec, NamesAndPrefixesAreUnique) {
  SceneSpec spec = Empty();
  spec.robots = {{.name = "a", .path = "a.xml", .prefix = "l_"},
                 {.name = "a", .path = "a.xml", .prefix = "l_"}};
  spec.objects = {Cube("cube"), Cube("cube")};
  spec.cameras = {{.name = "c", .pos = Vec3{}, .fovy = 45},
                  {.name = "c", .pos = Vec3{}, .fovy = 45}};
  EXPECT_EQ(
      ValidationError(spec),
      "it is not valid, 4 problems:\n"
      "  robot 'a' (robots[1]): prefix 'l_' is also that of robot 'a' (robots[0]); each needs its "
      "own, for example `prefix: right_`\n"
      "  robot 'a' (robots[1]).name: 'a' is used twice; each robot needs its own\n"
      "  object 'cube' (objects[1]): name 'cube' is also that of objects[0]; each needs its own\n"
      "  camera 'c' (cameras[1]): name 'c' is also that of cameras[0]; each needs its own");
}

TEST(SceneSpec, ProblemsOfPartsCarryTheirPath) {
  SceneSpec spec = Empty();
  spec.options.impratio = -1;
  spec.objects.push_back(Cube("cube")).mass = 0;
  spec.robots.push_back({.path = "a.xml"}).attachments.push_back({.attach_to = Site("s")});
  EXPECT_EQ(ValidationError(spec),
            "it is not valid, 3 problems:\n"
            "  options.impratio: -1 must be greater than 0\n"
            "  robots[0].attachments[0].mjcf_path: is required: the model file to attach\n"
            "  object 'cube' (objects[0]).mass: 0 must be greater than 0");
}

TEST(SceneSpec, ReportsListElementsByName) {
  SceneSpec spec = Empty();
  spec.objects.push_back({.name = "red_cube",
                          .shape = Shape::kBox,
                          .size = Vec3{.02, .02, .02},
                          .rgba = Vec4{1, 0, 0, 1},
                          .friction = Vec3{1, .1, .1}});
  spec.cameras.push_back({.name = "top", .pos = Vec3{}});
  spec.robots.push_back({.name = "left"});
  spec.robots.push_back({.path = "a.xml", .prefix = "b_"})
      .attachments.push_back({.attach_to = Site("s"), .prefix = "g_"});
  EXPECT_EQ(ValidationError(spec),
            "it is not valid, 4 problems:\n"
            "  robot 'left' (robots[0]).path: is empty: give the robot's model file, or a config\n"
            "  robot 'b_' / attachment 'g_' (robots[1].attachments[0]).mjcf_path: is required: the "
            "model file to attach\n"
            "  object 'red_cube' (objects[0]).mass: a primitive needs its mass in kg\n"
            "  camera 'top' (cameras[0]).fovy: is required: the vertical field of view in "
            "degrees, for example 45");
}

TEST(SceneSpec, ReportsListElementsOfAFileByName) {
  EXPECT_EQ(ParseError<SceneSpec>("name: a\ntimestep: 0.002\nadd_floor: true\nadd_skybox: true\n"
                                  "objects:\n  - {shape: box, mass: banana, name: red_cube, size: "
                                  "[1, 1, 1], rgba: [1, 1, 1, 1], friction: [1, 1, 1]}\n"),
            "f.yaml is not valid: f.yaml:6:24: object 'red_cube' (objects[0]).mass: expected a "
            "number, found 'banana'. Mass, kg.");
}

}  // namespace
}  // namespace robocell
