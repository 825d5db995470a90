// From an environment's configuration to its scene: robots and grippers in the rig, objects and
// cameras in their frames. Pure: nothing is read or compiled.
//
//   const EnvConfig config = EnvConfig::Load("duo.yaml");
//   Scene scene = Scene::Build(EnvSceneSpec(config));
//   Robot left = Robot::Of(scene, "left"), gripper = Robot::Of(scene, "gripperleft");
//
// CompileEnvScene(config) is what an environment simulates, which a saved scene may be instead.
//
// Robots stand on fixed bases without the pedestal of their configuration, and what a model's file
// says of its root's pose is dropped, unless the robot's configuration has reset_root_pose: false.
#pragma once

#include <string>

#include "robocell/scene/compiled_scene.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

// SpecError lists all that is wrong with the configuration.
SceneSpec EnvSceneSpec(const EnvConfig& config);

// Compiled: that scene, or the file of EnvConfig::saved_scene. Errors of CompileScene and
// CompileSavedScene.
std::shared_ptr<CompiledScene> CompileEnvScene(const EnvConfig& config);

// Name of a robot's gripper in the scene if it is one of `grippers`: "gripperleft".
std::string MountedGripperName(const std::string& robot);

}  // namespace robocell
