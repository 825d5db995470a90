// For tests only: the arm of two joints with a change of its model.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {

class ChangedArm : public ::testing::Test {
 protected:
  std::shared_ptr<const CompiledScene> Compiled(const std::string& model) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "a", .config = ArmConfig(folder.Write("arm", model))});
    return CompileScene(spec);
  }
  // The arm with something put before a text of its model.
  static std::string With(const std::string& what, const std::string& before) {
    std::string model = kTwoJointArm;
    return model.insert(model.find(before), what);
  }
  ModelFolder folder;
};

}  // namespace robocell
