// For tests only: a robot whose model stands beside its origin, on a pedestal.
#pragma once

#include <fmt/format.h>

#include "robocell/scene/testing/scenes.h"

namespace robocell {

// The arm of ALOHA: its file places it beside the origin, at the edge of a table.
inline constexpr const char* kAside =
    R"(<worldbody><body name="base" pos="-.469 -.019 {}" euler="0 0 90">
  <geom type="box" size=".05 .05 .02" pos="0 0 .02"/>
  <body name="link" pos="0 0 .1"><joint name="j"/><geom type="box" size=".02 .02 .1" mass="1"/></body>
</body></worldbody>)";

inline RobotSpec AsideOnAPedestal(ModelFolder& folder, double height) {
  RobotSpec robot{.prefix = "r_",
                  .base = BaseConfig{.kind = BaseKind::kMocap, .size = Vec3{0.2, 0.2, 0.3}}};
  robot.config = RobotConfig{
      .name = "r", .model = folder.Write("aside", fmt::format(fmt::runtime(kAside), height))};
  return robot;
}

inline SceneSpec WithRobot(const RobotSpec& robot) {
  SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = false};
  spec.robots.push_back(robot);
  return spec;
}

}  // namespace robocell
