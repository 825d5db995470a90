// Parts of an EnvConfig: what is placed in one of its frames, and how its simulation runs.
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/env_action.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/types.h"

namespace robocell {

// A model placed in the frame of the dictionary that it stands in.
struct EnvObject {
  std::string mjcf_path = {};
  Pose offset = {};
  std::optional<bool> fixed = {};

  static constexpr const char* kTypeName = "EnvObject";
  static constexpr bool kWrittenAsPair = true;  // in Python: (mjcf_path, offset)
  template <class V>
  static void Fields(V&& v) {
    v("mjcf_path", &EnvObject::mjcf_path, "Model file: path, `menagerie:...` or built-in name.");
    v("offset", &EnvObject::offset,
      "Pose of the model's root body in that frame; what the file says of it is dropped.");
    v("fixed", &EnvObject::fixed, "Unset: as authored. A robot's frame carries fixed ones only.");
  }
  void Validate(Problems& problems) const;
};

// Where a camera is added: in the root frame, or at a robot's attachment site.
struct CameraAdderConfig {
  std::string xml_path = {};
  std::optional<double> fovy = {};
  Pose offset = {};
  std::string robot_name = {};
  std::string attachment_site = {};

  static constexpr double kFovy = 60;  // degrees, of a camera without a model

  static constexpr const char* kTypeName = "CameraAdderConfig";
  template <class V>
  static void Fields(V&& v) {
    v("xml_path", &CameraAdderConfig::xml_path,
      "Model with one camera and its housing; a camera alone unless set.");
    v("fovy", &CameraAdderConfig::fovy,
      "Vertical field of view, degrees; 60 unless set, or that of the model's camera.",
      Check::kPositive);
    v("offset", &CameraAdderConfig::offset,
      "Pose of the camera (MuJoCo's axes: it looks along -z) or of its model's root body: in the "
      "root frame, or with robot_name in that robot's attachment site.");
    v("robot_name", &CameraAdderConfig::robot_name,
      "The robot that carries the camera; it belongs to the rig unless set.");
    v("attachment_site", &CameraAdderConfig::attachment_site,
      "Another site of that robot, by its name without prefix, in the place of its attachment "
      "site.");
  }
  void Validate(Problems& problems) const;
};

// How the simulation runs, and when a step of the environment ends.
struct SimSettings {
  double timestep = 0.002;
  bool async_control = false;
  double frequency = 30;
  double max_convergence_time = 1;
  bool realtime = false;
  OnCollision on_collision = OnCollision::kStop;

  static constexpr const char* kTypeName = "SimSettings";
  template <class V>
  static void Fields(V&& v) {
    v("timestep", &SimSettings::timestep, "One step of the engine, seconds.", Check::kPositive);
    v("async_control", &SimSettings::async_control,
      "Steps end after 1/frequency, whatever the robots have done by then; else when they have "
      "arrived.");
    v("frequency", &SimSettings::frequency, "Steps per second with async_control.",
      Check::kPositive);
    v("max_convergence_time", &SimSettings::max_convergence_time,
      "Without async_control a step ends after this time at the latest, simulated seconds.",
      Check::kPositive);
    v("realtime", &SimSettings::realtime,
      "Steps take at least as long as the time that they simulate.");
    v("on_collision", &SimSettings::on_collision,
      "When a robot runs into something: stop (the step ends) or report (it goes on).");
  }
  void Validate(Problems& problems) const;
};

// What the robots are to do: pick up an object, which lies around its place at each reset.
struct EnvTaskConfig {
  TaskKind kind = TaskKind::kPick;
  std::string object = {};
  Vec2 spread = {0, 0};
  bool rotate = true;
  double lift_height = 0.05;

  static constexpr const char* kTypeName = "EnvTaskConfig";
  template <class V>
  static void Fields(V&& v) {
    v("kind", &EnvTaskConfig::kind, "pick.");
    v("object", &EnvTaskConfig::object, "The object, by its id in root_frame_objects.");
    v("spread", &EnvTaskConfig::spread,
      "How far it lies from its place there, uniform between plus and minus these, along x and y "
      "of the root frame, metres.",
      Check::kNonNegative);
    v("rotate", &EnvTaskConfig::rotate, "Turn it by any angle about the root frame's z too.");
    v("lift_height", &EnvTaskConfig::lift_height,
      "Success: lifted this far above where the episode began, metres, and held only by robots.",
      Check::kPositive);
  }
};

// What is around the robots' actions and observations.
struct WrapperConfig {
  bool binary_gripper = true;
  bool home_on_reset = true;
  bool include_depth = false;

  static constexpr const char* kTypeName = "WrapperConfig";
  template <class V>
  static void Fields(V&& v) {
    v("binary_gripper", &WrapperConfig::binary_gripper,
      "A gripper's action is open (0.5 and more) or closed, and it is observed as it was told; "
      "else both are its opening, 0 closed ... 1 open.");
    v("home_on_reset", &WrapperConfig::home_on_reset,
      "Resets put the arms at home; else they stay where they are.");
    v("include_depth", &WrapperConfig::include_depth,
      "Streams have depth images, whether they ask for them or not.");
  }
};

}  // namespace robocell
