// SceneSpec: the contents of a scene and their poses. Plain data: Scene::Build or CompileScene
// turns it into a simulation.
//
//   SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = true};
//   spec.robots.push_back({.path = "arm.xml"});
//   spec.objects.push_back({.name = "cube", .shape = Shape::kBox, .size = Vec3{.02, .02, .02},
//                           .rgba = Vec4{1, .5, 0, 1}, .mass = .1, .friction = Vec3{.8, .02, .001},
//                           .pos = Vec3{.4, 0, .02}});
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/camera_spec.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/robot_spec.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/sim_options.h"
#include "robocell/spec/types.h"

namespace robocell {

struct SceneSpec {
  std::string name = "scene";
  std::optional<std::string> base = {};
  std::optional<double> timestep = {};
  Vec3 gravity = {0, 0, -9.81};
  std::optional<bool> add_floor = {};
  std::optional<bool> add_skybox = {};
  SimOptions options = {};
  Pose root_frame_to_world = {};
  Pose shared_base_frame_to_root_frame = {};
  List<RobotSpec> robots = {};
  List<SceneObject> objects = {};
  List<CameraSpec> cameras = {};
  // Folder of the file, where relative paths start. Not a field, because it is not a property of
  // the scene.
  std::string source_dir = {};
  Locations locations = {};

  static constexpr const char* kTypeName = "SceneSpec";
  template <class V>
  static void Fields(V&& v) {
    v("name", &SceneSpec::name, "Name in messages.");
    v("base", &SceneSpec::base,
      "An MJCF file or built-in name to start from; an empty world unless set.");
    v("timestep", &SceneSpec::timestep,
      "Timestep of the engine, seconds; required unless `base` sets it.", Bound::kPositive);
    v("gravity", &SceneSpec::gravity, "Acceleration of gravity, m/s^2.");
    v("add_floor", &SceneSpec::add_floor, "Add a floor plane at z = 0; required without `base`.");
    v("add_skybox", &SceneSpec::add_skybox, "Add a sky and a light; required without `base`.");
    v("options", &SceneSpec::options, "Solver options of the whole scene.");
    v("root_frame_to_world", &SceneSpec::root_frame_to_world,
      "Pose of the root frame, that of the rig, in the world.");
    v("shared_base_frame_to_root_frame", &SceneSpec::shared_base_frame_to_root_frame,
      "Pose of the shared base frame, also of the rig, in the root frame.");
    v("robots", &SceneSpec::robots, "The robots.");
    v("objects", &SceneSpec::objects, "The objects.");
    v("cameras", &SceneSpec::cameras, "Cameras of the scene.");
  }
  void Validate(Problems& problems) const;

  // Reads a scene file. Throws SpecError with all problems and their file:line:column.
  static SceneSpec Load(const std::string& path);
};

}  // namespace robocell
