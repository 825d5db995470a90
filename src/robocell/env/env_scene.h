// Makes the scene of an environment's configuration: robots and grippers in the rig, objects and
// cameras in their frames. A pure function: it reads and compiles nothing.
//
//   const EnvConfig config = EnvConfig::Load("duo.yaml");
//   Scene scene = Scene::Build(EnvSceneSpec(config));
//   Robot left = Robot::Of(scene, "left"), gripper = Robot::Of(scene, "gripperleft");
//
// CompileEnvScene(config) gives the scene that an environment simulates, which may also be a saved
// scene.
//
// Robots stand on fixed bases without the pedestal of their configuration. The root pose in a model
// file is dropped unless the robot's configuration has reset_root_pose: false.
#pragma once

#include <string>

#include "robocell/scene/compiled_scene.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

// Throws SpecError with all problems of the configuration.
SceneSpec EnvSceneSpec(const EnvConfig& config);

// Compiles that scene, or loads the file of EnvConfig::saved_scene. Throws the errors of
// CompileScene and CompileSavedScene.
std::shared_ptr<CompiledScene> CompileEnvScene(const EnvConfig& config);

// Returns the name of a robot's gripper in the scene if it is one of `grippers`: "gripperleft".
std::string MountedGripperName(const std::string& robot);

}  // namespace robocell
