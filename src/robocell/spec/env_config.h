// EnvConfig: a cell of one or several robots as an environment: the robots, the frames that they
// share, what is placed in which frame, and its cameras. Usually a YAML file; see
// docs/environments.md. EnvSceneSpec (env/env_scene.h) turns it into a scene.
//
//   robots: {left: fr3.yaml, right: fr3.yaml}
//   robot_to_shared_base_frame: {left: {pos: [0, 0.3, 0]}, right: {pos: [0, -0.3, 0]}}
//   shared_base_frame_to_root_frame: {pos: [0, 0, 0.4]}
//   root_frame_objects: {mount: {mjcf_path: mount.xml}}
//   camera_adds: {wrist: {robot_name: left, offset: {pos: [0.05, 0, 0], euler: [180, 0, 0]}}}
//   cameras: {streams: [{name: wrist, camera: wrist}]}
//
// Names in the scene: robots are called as here, their elements begin with `robot{name}_`; grippers
// are robots of their own, `gripper{name}` with the prefix `gripper{name}_`; elements of objects
// begin with `{id}_`; cameras keep their name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/camera_spec.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/env_action.h"
#include "robocell/spec/env_parts.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/pick_task_config.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/sim_options.h"
#include "robocell/spec/task_spec.h"
#include "robocell/spec/types.h"

namespace robocell {

struct EnvConfig {
  std::string name = "env";
  Map<RobotConfig> robots = {};
  Map<RobotConfig> grippers = {};
  Map<Pose> gripper_offsets = {};
  std::string scene = "empty_world";
  std::optional<bool> add_floor = {};
  Pose root_frame_to_world = {};
  Pose shared_base_frame_to_root_frame = {};
  Map<Pose> robot_to_shared_base_frame = {};
  std::string alternative_combined_robot_mjcf = {};
  Map<EnvObject> world_frame_objects = {};
  Map<EnvObject> root_frame_objects = {};
  Map<Map<EnvObject>> robot_frame_objects = {};
  Map<ObjectVariation> variations = {};
  std::string saved_scene = {};
  Map<CameraAdderConfig> camera_adds = {};
  CameraSystemConfig cameras = {};
  bool add_gravcomp = false;
  bool headless = true;
  std::optional<TaskSpec> task = {};
  NameList features = {};
  ControlMode control_mode = ControlMode::kJoints;
  RelativeTo relative_to = RelativeTo::kLastStep;
  std::vector<double> max_relative_movement = {};
  std::vector<double> max_target_lead = {};
  SimSettings sim = {};
  WrapperConfig wrappers = {};
  SimOptions options = {};
  // Where the file was: relative paths start here. Not a field. Neither is where each value stood.
  std::string source_dir = {};
  Locations locations = {};

  static constexpr const char* kTypeName = "EnvConfig";
  template <class V>
  static void Fields(V&& v) {
    v("name", &EnvConfig::name, "Used in messages.");
    v("robots", &EnvConfig::robots, "Names to robots: the file of each, or its fields.");
    v("grippers", &EnvConfig::grippers,
      "Robot to gripper: a configuration with only a gripper group, mounted at the robot's "
      "attachment site. Robots that have a gripper of their own keep it.");
    v("gripper_offsets", &EnvConfig::gripper_offsets,
      "Robot to the pose of its gripper in the attachment site; the identity unless set.");
    v("scene", &EnvConfig::scene, "Base scene: an MJCF file or a built-in name.");
    v("add_floor", &EnvConfig::add_floor,
      "Add a floor plane at z = 0 of the world. Unset: yes with the scene empty_world, which has "
      "none; no with others.");
    v("root_frame_to_world", &EnvConfig::root_frame_to_world,
      "The rig: pose of the root frame in the world. Moves robots, root objects and cameras.");
    v("shared_base_frame_to_root_frame", &EnvConfig::shared_base_frame_to_root_frame,
      "The rig: pose of the shared base frame, the one of all actions, in the root frame.");
    v("robot_to_shared_base_frame", &EnvConfig::robot_to_shared_base_frame,
      "Robot to the pose of its base in the shared base frame; the identity unless set.");
    v("alternative_combined_robot_mjcf", &EnvConfig::alternative_combined_robot_mjcf,
      "One model with all robots, in the place of theirs: under one root body, which stands in the "
      "root frame; the names of robot `left` begin with `robotleft_`. Edits, attachments and "
      "cameras of the robots' files are left out, and the robots stand where the model has them.");
    v("world_frame_objects", &EnvConfig::world_frame_objects,
      "Objects that stay in the room, by their ids.");
    v("root_frame_objects", &EnvConfig::root_frame_objects,
      "Objects that move with the rig, by their ids.");
    v("robot_frame_objects", &EnvConfig::robot_frame_objects,
      "Robot to objects at its attachment site, by their ids.");
    v("variations", &EnvConfig::variations,
      "How objects of the room and of the rig differ from episode to episode, by their ids.");
    v("saved_scene", &EnvConfig::saved_scene,
      "A file that Scene.save_xml wrote of this environment's scene, perhaps changed since: "
      "simulated in the place of what the configuration describes.");
    v("camera_adds", &EnvConfig::camera_adds,
      "Cameras to add, by their names; `cameras` says what is taken from them.");
    v("cameras", &EnvConfig::cameras,
      "Image streams: of these cameras, of the robots' and of the base scene's.");
    v("add_gravcomp", &EnvConfig::add_gravcomp,
      "Compensate gravity on robots and grippers, whatever their files say.");
    v("headless", &EnvConfig::headless,
      "Without a window. Else robocell.gym opens one, where there is a display.");
    v("task", &EnvConfig::task,
      "What the robots are to do: the kind of task and its fields; none unless set.");
    v("features", &EnvConfig::features,
      "What is observed beside robots, objects and task: registered features by their names, "
      "sensors and all else of the cell by the names that datasets have; * stands for any part: "
      "sensors/*.");
    v("control_mode", &EnvConfig::control_mode,
      "What actions are: joints, or the TCP in the shared base frame as cartesian_trpy "
      "(translation, roll pitch yaw) or cartesian_tquat (translation, quaternion xyzw).");
    v("relative_to", &EnvConfig::relative_to,
      "What actions are added to: last_step (where the robot was last sent), configured_origin "
      "(where it was at the reset) or none.");
    v("max_relative_movement", &EnvConfig::max_relative_movement,
      "How far one action can send a robot from where it was last sent: [metres, radians], or one "
      "number for joints. Unset: 0.5 m and 90 degrees, joints 5 degrees; absolute actions without "
      "limit.",
      Bound::kPositive);
    v("max_target_lead", &EnvConfig::max_target_lead,
      "How far the target that an action starts from may lead the arm: [metres, radians], or one "
      "number for joints. When something blocks the arm, the excess is dropped with the next "
      "action. Unset: 0.02 m and 0.1 rad.",
      Bound::kPositive);
    v("sim", &EnvConfig::sim, "How the simulation runs, and when a step ends.");
    v("wrappers", &EnvConfig::wrappers, "Grippers, resets and depth.");
    v("options", &EnvConfig::options, "Solver options.");
  }
  void Validate(Problems& problems) const;

  // What max_relative_movement says, or its default; infinite without a limit.
  StepLimit step_limit() const;
  // The value of max_target_lead, or its default. In joint mode the rotation applies to hinges and
  // the translation to slides.
  StepLimit target_lead() const;
  // Whether the robot's gripper is one of `grippers`, and not its own.
  bool has_mounted_gripper(const std::string& robot) const;
  // What add_floor says, or its default.
  bool has_added_floor() const;
  // The pose of the robot's base in the shared base frame.
  Pose robot_in_shared_base(const std::string& robot) const;

  // Reads an environment file and the robot files it names. SpecError lists all problems with
  // file:line:column.
  static EnvConfig Load(const std::string& path);
};

}  // namespace robocell
