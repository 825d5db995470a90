// For tests only: viewers in memory, and a user who acts on them.
#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Core>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/render/gl_context.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/robot_config.h"
#include "robocell/testing/skip.h"
#include "robocell/viewer/viewer.h"

namespace robocell {

inline const ViewerOptions kInMemory{.width = 640, .height = 480, .on_screen = false};

// Acts as a user: in memory, without a display.
class Viewers : public testing::Test {
 protected:
  Viewers() : scene_(Scene::Build(Spec())) {}
  void SetUp() override {
    try {
      DescribeGl();
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  static SceneSpec Spec() {
    SceneSpec spec = EmptyScene();
    const RobotConfig config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
    spec.robots.push_back({.name = "arm", .config = config, .control_modes = config.used_modes()});
    spec.objects.push_back(BoxObject("cube", {0.6, 0.2, 0.02}));
    spec.cameras.push_back(
        {.name = "side", .pos = Vec3{0, -3, 0.7}, .fovy = 45, .look_at = Vec3{0, 0, 0.5}});
    return spec;
  }
  static void Key(Viewer& viewer, int key) {
    viewer.Post({.type = InputEvent::kKey, .key = key});
    viewer.Show();
  }
  static void Drag(Viewer& viewer, Eigen::Vector2d from, Eigen::Vector2d to,
                   int button = mjBUTTON_LEFT, bool control = false) {
    viewer.Post({.type = InputEvent::kMove, .x = from.x(), .y = from.y()});
    viewer.Post({.type = InputEvent::kPress,
                 .x = from.x(),
                 .y = from.y(),
                 .button = button,
                 .control = control});
    for (int i = 1; i <= 5; ++i) {
      const Eigen::Vector2d at = from + (to - from) * i / 5.;
      viewer.Post({.type = InputEvent::kMove, .x = at.x(), .y = at.y(), .control = control});
    }
    viewer.Show();
  }
  static void Release(Viewer& viewer, Eigen::Vector2d at, int button = mjBUTTON_LEFT) {
    viewer.Post({.type = InputEvent::kRelease, .x = at.x(), .y = at.y(), .button = button});
    viewer.Show();
  }
  static void Click(Viewer& viewer, const char* section, const char* item, double offset = 0) {
    const auto [x, y] = viewer.PlaceOf(section, item);
    const Eigen::Vector2d at(x + offset, y);
    Drag(viewer, at, at);
    if (viewer.is_running()) Release(viewer, at);
  }

  Scene scene_;
};

}  // namespace robocell
