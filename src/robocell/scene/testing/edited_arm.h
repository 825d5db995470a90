// For tests only: a robot whose model is changed by edits.
#pragma once

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/yaml.h"

namespace robocell {

inline constexpr const char* kHinge = R"(<worldbody><body name="base"><geom size="0.1"/><body>
  <joint name="hinge" axis="0 0 1"/><geom size="0.1"/></body></body></worldbody>)";
inline constexpr const char* kNoEdit = "{body: base, pos: [0, 0, 0]}";

class EditedArm : public ::testing::Test {
 protected:
  // The two-joint arm with these edits, written as YAML.
  Scene Build(const std::string& edits) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.config = ParseYaml<RobotConfig>("{name: arm, model: " + model +
                                                            ", edits: [" + edits + "]}"),
                           .prefix = "r_"});
    return Scene::Build(spec);
  }
  int Id(const Scene& scene, mjtObj kind, const char* name) {
    return RequireId(scene.model(), kind, name, "test");
  }

  ModelFolder folder;
  std::string model = folder.Write("arm", kTwoJointArm);
};

}  // namespace robocell
