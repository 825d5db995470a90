// Which camera a stream means.
#include "robocell/datagen/episode_cameras.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

Scene Cell(bool two_robots, const std::string& scene_camera = "") {
  SceneSpec spec = SceneWith({.name = "a", .config = Rc7(), .prefix = "a/"});
  if (two_robots)
    spec.robots.push_back({.name = "b", .config = Rc7(), .prefix = "b/", .pos = {0, 2, 0}});
  if (!scene_camera.empty()) {
    CameraSpec camera;
    camera.name = scene_camera;
    camera.pos = {1, 0, 1};
    camera.fovy = 45;
    spec.cameras.push_back(camera);
  }
  return Scene::Build(spec);
}

CameraConfig Stream(const std::string& camera) { return {.name = "wrist", .camera = camera}; }

TEST(FindCameraName, TakesTheExactNameBeforeThatOfARobot) {
  EXPECT_EQ(FindCameraName(Cell(false), Stream("wrist_camera")), "a/wrist_camera");
  EXPECT_EQ(FindCameraName(Cell(false, "wrist_camera"), Stream("wrist_camera")), "wrist_camera");
  EXPECT_EQ(FindCameraName(Cell(true), Stream("b/wrist_camera")), "b/wrist_camera");
}

TEST(FindCameraName, OneOfTwoRobotsHasToBeNamed) {
  ExpectThrow<ArgumentError>(
      [] { FindCameraName(Cell(true), Stream("wrist_camera")); },
      "stream 'wrist': camera 'wrist_camera' is one of a/wrist_camera, b/wrist_camera; write the "
      "full name of the one that is meant");
}

}  // namespace
}  // namespace robocell
