// Parts of an EnvConfig: the objects in its frames, and the settings of its simulation.
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/env_action.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/types.h"

namespace robocell {

// A model, or a primitive, placed in the frame of the dictionary that contains it.
struct EnvObject {
  std::string mjcf_path = {};
  Pose offset = {};
  std::optional<bool> fixed = {};
  std::optional<Shape> shape = {};
  std::optional<Vec3> size = {};
  std::optional<double> mass = {};
  std::optional<Vec4> rgba = {};
  std::optional<Vec3> friction = {};

  static constexpr Vec4 kRgba = {0.8, 0.8, 0.8, 1};
  static constexpr Vec3 kFriction = {1, 0.005, 0.0001};  // the engine's default

  static constexpr const char* kTypeName = "EnvObject";
  static constexpr bool kWrittenAsPair = true;  // in Python: (mjcf_path, offset)
  // Added to messages where names and objects stand in place of one object's fields.
  static constexpr const char* kWhenNested =
      "objects by name stand where one object is expected; those that follow a robot's wrist go "
      "into robot_frame_objects: {robot: {id: ...}}, all others are {id: ...} without a robot";
  template <class V>
  static void Fields(V&& v) {
    v("mjcf_path", &EnvObject::mjcf_path, "Model file: path, `menagerie:...` or built-in name.");
    v("offset", &EnvObject::offset,
      "Pose of the model's root body in that frame. The pose in the model file is dropped.");
    v("fixed", &EnvObject::fixed,
      "true: the object stays in place. false: it moves freely and falls. Unset: a model falls if "
      "its root has a free joint, a primitive falls, and an object in a robot's frame is mounted "
      "there.");
    v("shape", &EnvObject::shape, "Primitive, instead of a model: box, sphere or cylinder.");
    v("size", &EnvObject::size,
      "Half sizes of a primitive, metres: box x y z; sphere radius 0 0; cylinder radius, half "
      "height, 0.",
      Bound::kNonNegative);
    v("mass", &EnvObject::mass, "Mass of a primitive, kg.", Bound::kPositive);
    v("rgba", &EnvObject::rgba, "Colour of a primitive. Unset: light grey.", Bound::kFraction);
    v("friction", &EnvObject::friction,
      "Sliding, torsional and rolling friction of a primitive. Unset: the engine's own.",
      Bound::kNonNegative);
  }
  // Returns it as an object of a scene, without its name and place.
  SceneObject AsSceneObject() const;
  void Validate(Problems& problems) const;
};

// Random variation of an object's model, drawn at each reset.
struct ObjectVariation {
  Vec2 mass = {1, 1};
  Vec2 friction = {1, 1};
  double colour = 0;

  static constexpr const char* kTypeName = "ObjectVariation";
  template <class V>
  static void Fields(V&& v) {
    v("mass", &ObjectVariation::mass,
      "Smallest and largest factor of mass and inertia; uniform between them.", Bound::kPositive);
    v("friction", &ObjectVariation::friction,
      "Smallest and largest factor of all three kinds of friction. In a contact the engine uses "
      "the larger friction of the two geoms.",
      Bound::kPositive);
    v("colour", &ObjectVariation::colour,
      "Largest change of red, green and blue each, within 0 ... 1.", Bound::kFraction);
  }
  void Validate(Problems& problems) const;
};

// The place of an added camera: in the root frame, or at a robot's attachment site.
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
      "Model with one camera and its housing. Unset: a camera alone.");
    v("fovy", &CameraAdderConfig::fovy,
      "Vertical field of view, degrees. Unset: that of the model's camera, else 60.",
      Bound::kPositive);
    v("offset", &CameraAdderConfig::offset,
      "Pose of the camera (MuJoCo's axes: it looks along -z) or of its model's root body, in the "
      "root frame, or with robot_name in that robot's attachment site.");
    v("robot_name", &CameraAdderConfig::robot_name,
      "The robot that carries the camera. Unset: the camera belongs to the rig.");
    v("attachment_site", &CameraAdderConfig::attachment_site,
      "Another site of that robot, by its name without prefix, instead of its attachment site.");
  }
  void Validate(Problems& problems) const;
};

// Settings of the simulation, and when a step of the environment ends.
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
    v("timestep", &SimSettings::timestep, "Timestep of the engine, seconds.", Bound::kPositive);
    v("async_control", &SimSettings::async_control,
      "Steps end after 1/frequency, even if the robots still move. false: steps end when the "
      "robots have arrived.");
    v("frequency", &SimSettings::frequency, "Steps per second with async_control.",
      Bound::kPositive);
    v("max_convergence_time", &SimSettings::max_convergence_time,
      "Longest step without async_control, simulated seconds.", Bound::kPositive);
    v("realtime", &SimSettings::realtime,
      "Simulated time passes no faster than the clock: each step waits until its simulated time "
      "has passed. Time that the caller spent since the last step counts.");
    v("on_collision", &SimSettings::on_collision,
      "Reaction to a collision of a robot: stop (the step ends), report (it continues) or guard "
      "(each step is simulated ahead, and an action that leads to a collision is not executed).");
  }
  void Validate(Problems& problems) const;
};

// Settings around the robots' actions and observations.
struct WrapperConfig {
  bool binary_gripper = true;
  bool home_on_reset = true;
  bool include_depth = false;

  static constexpr const char* kTypeName = "WrapperConfig";
  template <class V>
  static void Fields(V&& v) {
    v("binary_gripper", &WrapperConfig::binary_gripper,
      "A gripper's action is open (0.5 and more) or closed, and its observation is its last "
      "command. false: both are its opening, 0 closed ... 1 open.");
    v("home_on_reset", &WrapperConfig::home_on_reset,
      "Resets move the arms to home. false: the arms stay in place.");
    v("include_depth", &WrapperConfig::include_depth,
      "All streams have depth images, even those without `depth`.");
  }
};

}  // namespace robocell
