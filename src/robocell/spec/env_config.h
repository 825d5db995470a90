// EnvConfig: a cell of one or several robots as an environment: the robots, their common frames,
// the objects in each frame, and its cameras. Usually a YAML file; see docs/environments.md.
// EnvSceneSpec (env/env_scene.h) turns it into a scene.
//
//   robots: {left: fr3.yaml, right: fr3.yaml}
//   robot_to_shared_base_frame: {left: {pos: [0, 0.3, 0]}, right: {pos: [0, -0.3, 0]}}
//   shared_base_frame_to_root_frame: {pos: [0, 0, 0.4]}
//   root_frame_objects: {mount: {mjcf_path: mount.xml}}
//   camera_adds: {wrist: {robot_name: left, offset: {pos: [0.05, 0, 0], euler: [180, 0, 0]}}}
//   cameras: {streams: [{name: wrist, camera: wrist}]}
//
// Names in the scene: robots have the names of this file, their elements begin with `robot{name}_`;
// grippers are separate robots, `gripper{name}` with the prefix `gripper{name}_`; elements of
// objects begin with `{id}_`; cameras keep their name.
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
#include "robocell/spec/object_place.h"
#include "robocell/spec/randomize_config.h"
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
  Maybe<RandomizeConfig> randomize = {};
  Map<ObjectPlace> places = {};
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
  // Folder of the file, where relative paths start. Like the locations of values it is not a field.
  std::string source_dir = {};
  Locations locations = {};

  static constexpr const char* kTypeName = "EnvConfig";
  template <class V>
  static void Fields(V&& v) {
    v("name", &EnvConfig::name, "Name in messages.");
    v("robots", &EnvConfig::robots, "Robots by name: the file of each, or its fields.");
    v("grippers", &EnvConfig::grippers,
      "Grippers by robot: a configuration with only a gripper group, mounted at the robot's "
      "attachment site. Robots that already have a gripper keep it.");
    v("gripper_offsets", &EnvConfig::gripper_offsets,
      "Poses of the grippers in the attachment sites, by robot. Unset: the identity.");
    v("scene", &EnvConfig::scene, "Base scene: an MJCF file or a built-in name.");
    v("add_floor", &EnvConfig::add_floor,
      "Add a floor plane at z = 0 of the world. Unset: yes in the scene empty_world, which has "
      "none; no in others.");
    v("root_frame_to_world", &EnvConfig::root_frame_to_world,
      "Pose of the root frame, that of the rig, in the world. It moves robots, root objects and "
      "cameras.");
    v("shared_base_frame_to_root_frame", &EnvConfig::shared_base_frame_to_root_frame,
      "Pose of the shared base frame, that of all actions, in the root frame.");
    v("robot_to_shared_base_frame", &EnvConfig::robot_to_shared_base_frame,
      "Poses of the robots' bases in the shared base frame, by robot. Unset: the identity.");
    v("alternative_combined_robot_mjcf", &EnvConfig::alternative_combined_robot_mjcf,
      "One model with all robots instead of one model each. Its one root body stands in the root "
      "frame, and the names of robot `left` begin with `robotleft_`. The robots stand where the "
      "model has them; edits, attachments and cameras of their files are not used.");
    v("world_frame_objects", &EnvConfig::world_frame_objects,
      "Objects that stay in the room, by their ids.");
    v("root_frame_objects", &EnvConfig::root_frame_objects,
      "Objects that move with the rig, by their ids.");
    v("robot_frame_objects", &EnvConfig::robot_frame_objects,
      "Objects at the robots' attachment sites, by robot and id.");
    v("variations", &EnvConfig::variations,
      "Random variations of objects of the room and of the rig in each episode, by their ids.");
    v("randomize", &EnvConfig::randomize,
      "Random lights, looks, physics and delays in each episode, as in runs. Instead of "
      "`variations`.");
    v("places", &EnvConfig::places,
      "Free objects by their ids, also of those that the task adds, and where each starts in "
      "relation to another object or a body of the scene. Unset: the task's own.");
    v("saved_scene", &EnvConfig::saved_scene,
      "A file that Scene.save_xml wrote of this environment's scene, and that may have been edited "
      "since. It is simulated instead of the scene that the configuration describes.");
    v("camera_adds", &EnvConfig::camera_adds,
      "Cameras to add, by their names; `cameras` has their image streams.");
    v("cameras", &EnvConfig::cameras,
      "Image streams of these cameras, the robots' and the base scene's.");
    v("add_gravcomp", &EnvConfig::add_gravcomp,
      "Compensate gravity on robots and grippers, even if their files do not.");
    v("headless", &EnvConfig::headless,
      "Open no window. false: robocell.gym opens one if there is a display.");
    v("task", &EnvConfig::task, "The kind of task and its fields. Unset: no task.");
    v("features", &EnvConfig::features,
      "Observations beside robots, objects and task: registered features by their names; sensors "
      "and everything else of the cell by its name in datasets. * stands for any part: "
      "robots/*/sensors/*.");
    v("control_mode", &EnvConfig::control_mode,
      "Form of the actions: joints, or the TCP in the shared base frame as cartesian_trpy "
      "(translation, roll pitch yaw) or cartesian_tquat (translation, quaternion xyzw).");
    v("relative_to", &EnvConfig::relative_to,
      "Reference of the actions: last_step (the robot's last target), configured_origin (its "
      "position at the reset) or none (absolute actions).");
    v("max_relative_movement", &EnvConfig::max_relative_movement,
      "Largest distance from a robot's last target to the next: [metres, radians], or one number "
      "for joints. Unset: 0.5 m and 1.571 rad (90 degrees), joints 0.0873 rad (5 degrees); "
      "absolute actions without limit.",
      Bound::kPositive);
    v("max_target_lead", &EnvConfig::max_target_lead,
      "Largest lead over the arm of the target that an action starts from: [metres, radians], or "
      "one number for joints. If an obstacle blocks the arm, the next action drops the excess. "
      "Unset: 0.02 m and 0.1 rad.",
      Bound::kPositive);
    v("sim", &EnvConfig::sim, "Settings of the simulation, and the end of a step.");
    v("wrappers", &EnvConfig::wrappers, "Settings of grippers, resets and depth.");
    v("options", &EnvConfig::options, "Solver options.");
  }
  void Validate(Problems& problems) const;

  // Returns max_relative_movement or its default; infinite without a limit.
  StepLimit step_limit() const;
  // Returns max_target_lead or its default. In joint mode the rotation applies to hinges and the
  // translation to slides.
  StepLimit target_lead() const;
  // Returns true if the robot's gripper is one of `grippers`, and not its own.
  bool has_mounted_gripper(const std::string& robot) const;
  // Returns add_floor or its default.
  bool has_added_floor() const;
  // Returns the pose of the robot's base in the shared base frame.
  Pose robot_in_shared_base(const std::string& robot) const;

  // Reads an environment file and the robot files that it names. Throws SpecError with all problems
  // and their file:line:column.
  static EnvConfig Load(const std::string& path);
};

}  // namespace robocell
