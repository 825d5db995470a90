// Tests images in observations: which cameras, when, and their content.
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/data/episode_schema.h"
#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// The built-in robot beside a floor, with a camera 1.5 m above that looks straight down at it.
EnvConfig Watched() {
  EnvConfig config = Rc7Env();
  config.add_floor = true;
  config.sim.async_control = true;
  config.cameras.resolution = {32, 24};
  config.camera_adds["top"] = {.fovy = 30, .offset = Pose(Eigen::Vector3d(3, 3, 1.5))};
  config.cameras.streams.push_back({.name = "top", .camera = "top"});
  return config;
}

std::vector<double> StandStill(const Env& env) {
  std::vector<double> action(static_cast<size_t>(env.layout().action.size()));
  action.back() = 1;
  return action;
}

TEST(EnvImages, DepthIsInMillimetres) {
  EnvConfig config = Watched();
  config.wrappers.include_depth = true;
  config.cameras.streams.push_back({.name = "up", .camera = "up", .rgb = false});
  config.camera_adds["up"] = {.offset = Pose::FromRpy({3, 3, 1}, {3.14159, 0, 0})};
  config.cameras.streams[1].segmentation = true;
  Env env(config);
  env.Reset();
  ASSERT_EQ(env.frames().size(), 2u);
  const CellImage& top = env.frames()[0];
  EXPECT_EQ(top.rgb.size(), 32u * 24 * 3);
  ASSERT_EQ(top.depth_mm.size(), 32u * 24);
  for (const uint16_t mm : top.depth_mm) EXPECT_NEAR(mm, 1500, 2);
  EXPECT_TRUE(top.bodies.empty());
  const CellImage& up = env.frames()[1];  // sees nothing
  EXPECT_TRUE(up.rgb.empty());
  for (const uint16_t mm : up.depth_mm) EXPECT_EQ(mm, 0);
  for (const uint16_t body : up.bodies) EXPECT_EQ(body, kNoSegment);
}

TEST(EnvImages, DepthSaturates) {
  EnvConfig config = Watched();
  config.wrappers.include_depth = true;
  config.camera_adds["top"].offset = Pose(Eigen::Vector3d(3, 3, 65.5));
  config.camera_adds["high"] = {.fovy = 30, .offset = Pose(Eigen::Vector3d(3, 3, 80))};
  config.cameras.streams.push_back({.name = "high", .camera = "high"});
  Env env(config);
  env.Reset();
  for (const uint16_t mm : env.frames()[0].depth_mm) EXPECT_NEAR(mm, 65500, 35);
  for (const uint16_t mm : env.frames()[1].depth_mm) EXPECT_EQ(mm, 65535);
}

TEST(EnvImages, ProjectedPointsMatchTheImage) {
  Env env(Watched());
  env.Reset();
  const CameraModel& camera = env.frames()[0].camera;
  const Eigen::Vector2d below = camera.Project({3, 3, 0});
  EXPECT_NEAR(below.x(), 15.5, 1e-6);
  EXPECT_NEAR(below.y(), 11.5, 1e-6);
}

TEST(EnvImages, FramesAreTakenAtTheRateOfTheirStream) {
  EnvConfig config = Watched();
  config.cameras.streams.push_back({.name = "slow", .camera = "top", .rate = 10});
  config.cameras.streams.push_back({.name = "fast", .camera = "top", .rate = 100});
  Env env(config);
  env.Reset();
  const std::vector<double> still = StandStill(env);
  double last = -1;
  for (int step = 1; step <= 12; ++step) {
    const double now = env.Step(still).time;
    EXPECT_EQ(env.frames()[0].time, now) << "with every observation";
    const double slow = env.frames()[1].time, fast = env.frames()[2].time;
    const double due = std::floor(now * 10 + 1e-9) / 10;
    EXPECT_GE(slow, due - 1e-9);
    EXPECT_LT(slow, due + config.sim.timestep);
    EXPECT_GT(fast, now - 0.01 - config.sim.timestep);
    EXPECT_LE(fast, now);
    EXPECT_GE(slow, last);
    last = slow;
  }
}

TEST(EnvImages, ShowTheStateOfTheirTime) {
  EnvConfig config = Watched();
  config.camera_adds["top"].offset = Pose(Eigen::Vector3d(0.3, 0, 1.5));
  config.cameras.streams.push_back({.name = "slow", .camera = "top", .rate = 2});
  Env env(config);
  env.Reset();
  const std::vector<uint8_t> start = env.frames()[0].rgb;
  EXPECT_EQ(env.frames()[1].rgb, start);
  std::vector<double> turn = StandStill(env);
  turn[0] = 0.08;
  for (int step = 0; step < 5; ++step) env.Step(turn);
  EXPECT_NE(env.frames()[0].rgb, start);
  EXPECT_EQ(env.frames()[1].rgb, start) << "the next one is due after half a second";
}

TEST(EnvImages, ContinueAfterTheSceneIsRecompiled) {
  EnvConfig config = Watched();
  config.cameras.streams[0].depth = true;
  Env env(config);
  env.Reset();
  Scene(env.scene()).AddObject(BoxObject("box", {3, 3, 0.02}));
  env.Step(StandStill(env));
  const std::vector<uint16_t>& depth = env.frames()[0].depth_mm;
  EXPECT_NEAR(depth[12 * 32 + 16], 1460, 3) << "the box is 4 cm high";
  EXPECT_NEAR(depth[0], 1500, 2);
}

TEST(EnvImages, RequireAnExistingCamera) {
  EnvConfig config = Watched();
  config.cameras.streams.push_back({.name = "hand", .camera = "wrst_camera"});
  ExpectThrow<NotFoundError>([&] { Env env(config); },
                             "stream 'hand': no camera 'wrst_camera'. Its cameras: ");
  config.cameras.streams[1].camera = "wrist_camera";  // of the robot
  Env env(config);
  env.Reset();
  EXPECT_EQ(env.frames()[1].name, "hand");
}

}  // namespace
}  // namespace robocell
