// For tests only: robots that are built from files, so that their problems have a place.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/files.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {

class RobotFiles : public ::testing::Test {
 protected:
  RobotFiles() { folder.Write("arm", kTwoJointArm); }

  // The file of a robot with the two-joint arm; `fields` begin in line 3.
  std::string RobotFile(const std::string& fields) {
    return File("arm.yaml", "name: arm\nmodel: arm.xml\n" + fields);
  }
  std::string File(const std::string& name, const std::string& text) {
    const std::string file = (folder.path() / name).string();
    AtomicWrite(file, text);
    return file;
  }
  static Scene BuildRobot(const std::string& file) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "left", .config = RobotConfig::Load(file)});
    return Scene::Build(spec);
  }

  ModelFolder folder;
};

}  // namespace robocell
