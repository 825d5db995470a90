#include "robocell/env/env_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/scene/saved_scene.h"
#include "robocell/scenes/randomized_model.h"
#include "robocell/spec/validate.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

// Some parts of SceneSpec have a position and a rotation instead of a pose.
template <class Spec>
void StandAt(Spec& spec, const AttachTarget& target, const Pose& pose) {
  spec.attach_to = target;
  spec.pos = ToVec3(pose.translation());
  spec.quat = pose.quaternion();
}

RobotSpec RobotInEnv(const EnvConfig& config, const RobotConfig& robot, const std::string& name,
                     const std::string& prefix) {
  RobotSpec spec{.name = name,
                 .config = robot,
                 .prefix = prefix,
                 .base = BaseConfig{},
                 .reset_root_pose = robot.reset_root_pose.value_or(true),
                 .control_modes = robot.used_modes()};
  if (config.add_gravcomp) spec.config->gravcomp = true;
  return spec;
}

// Returns one of several robots in one model, which comes with the first of them.
RobotSpec RobotInCombined(const EnvConfig& config, const RobotConfig& robot,
                          const std::string& name) {
  RobotSpec spec = RobotInEnv(config, robot, name, "");
  spec.model_prefix = "robot" + name + "_";
  spec.config->model = config.alternative_combined_robot_mjcf;
  spec.config->source_dir = config.source_dir;
  spec.config->edits = {};
  spec.config->attachments = {};
  spec.config->cameras = {};
  spec.attach_to = Root();
  const std::string lead = config.robots.keys().front();
  if (name != lead) spec.part_of = lead;
  return spec;
}

void AddRobots(const EnvConfig& config, SceneSpec& scene) {
  for (const auto& [name, robot] : config.robots.entries()) {
    if (!config.alternative_combined_robot_mjcf.empty()) {
      scene.robots.push_back(RobotInCombined(config, *robot, name));
      continue;
    }
    StandAt(scene.robots.push_back(RobotInEnv(config, *robot, name, "robot" + name + "_")),
            SharedBase(), config.robot_in_shared_base(name));
  }
  for (const auto& [name, gripper] : config.grippers.entries()) {
    if (!config.has_mounted_gripper(name)) continue;
    const Pose* offset = config.gripper_offsets.find(name);
    const std::string own_name = MountedGripperName(name);
    StandAt(scene.robots.push_back(RobotInEnv(config, *gripper, own_name, own_name + "_")),
            Attachment(name), offset ? *offset : Pose());
  }
}

void AddObjects(const Map<EnvObject>& objects, const AttachTarget& frame, SceneSpec& scene) {
  for (const auto& [id, object] : objects.entries()) {
    SceneObject& added = scene.objects.push_back(object->AsSceneObject());
    added.name = id;
    // Parts on a robot are mounted, whatever their model file says.
    if (frame.kind == AttachKind::kAttachment && !added.fixed) added.fixed = true;
    StandAt(added, frame, object->offset);
  }
}

// Returns the locations of the scene's parts in the environment's file; robots bring their own.
class SceneLocations {
 public:
  explicit SceneLocations(const Locations& config) : config_(config) {}
  void Put(const std::string& part, const std::string& field) {
    if (const auto at = config_.Exactly(field)) sources_[part] = *at;
  }
  void PutPlace(const std::string& part, const std::string& place) { sources_[part] = place; }
  // The i-th entry of a list of the scene, which the environment has at `field`.
  void PutEntry(const std::string& list, size_t i, const std::string& field) {
    const std::string part = fmt::format("{}[{}]", list, i);
    Put(part, field);
    for (const char* same : {"mjcf_path", "fixed", "shape", "size", "mass", "rgba", "friction"})
      Put(part + "." + same, field + "." + same);
    Put(part + ".mjcf_path", field + ".xml_path");  // a camera's
    Put(part + ".pos", field + ".offset");
  }
  Locations Get() const { return Locations(std::make_shared<const SourceMap>(sources_)); }

 private:
  const Locations& config_;
  SourceMap sources_;
};

// Returns where the task adds its objects: the line of its prepare(), or of `task` in the file.
std::string PlaceOfPrepare(const EnvConfig& config) {
  if (!config.task) return "";
  const std::string code =
      FindTaskKind(config.task->kind())->Make(*config.task)->PlaceOfHook("prepare");
  return code.empty() ? config.locations.Exactly("task").value_or("") : code;
}

size_t CountOfObjects(const EnvConfig& config) {
  size_t count = config.root_frame_objects.size() + config.world_frame_objects.size();
  for (const auto& [robot, objects] : config.robot_frame_objects.entries())
    count += objects->size();
  return count;
}

// `prepared`: place of the objects that the task adds, "" for none; `count`: all objects.
Locations LocateScene(const EnvConfig& config, const std::string& prepared = "", size_t count = 0) {
  SceneLocations scene(config.locations);
  scene.Put("base", "scene");
  size_t object = 0;
  const auto put_objects = [&](const Map<EnvObject>& objects, const std::string& field) {
    for (const std::string& id : objects.keys())
      scene.PutEntry("objects", object++, JoinPath(field, id));
  };
  put_objects(config.root_frame_objects, "root_frame_objects");
  put_objects(config.world_frame_objects, "world_frame_objects");
  for (const auto& [robot, objects] : config.robot_frame_objects.entries())
    put_objects(*objects, JoinPath("robot_frame_objects", robot));
  size_t camera = 0;
  for (const std::string& name : config.camera_adds.keys())
    scene.PutEntry("cameras", camera++, JoinPath("camera_adds", name));
  for (size_t i = CountOfObjects(config); !prepared.empty() && i < count; ++i)
    scene.PutPlace(fmt::format("objects[{}]", i), prepared);
  return scene.Get();
}

AttachTarget FrameOfCamera(const CameraAdderConfig& camera) {
  if (camera.robot_name.empty()) return Root();
  if (camera.attachment_site.empty()) return Attachment(camera.robot_name);
  return Site("robot" + camera.robot_name + "_" + camera.attachment_site);
}

void AddCameras(const EnvConfig& config, SceneSpec& scene) {
  for (const auto& [name, camera] : config.camera_adds.entries()) {
    CameraSpec spec{.name = name, .mjcf_path = camera->xml_path, .fovy = camera->fovy};
    if (spec.mjcf_path.empty() && !spec.fovy) spec.fovy = CameraAdderConfig::kFovy;
    StandAt(scene.cameras.push_back(std::move(spec)), FrameOfCamera(*camera), camera->offset);
  }
}

// Built-in scenes have no sky, so that a scene can bring one. The look of a user's scene is the
// user's.
bool IsBuiltinScene(const std::string& name) {
  const std::vector<std::string> all = assets::BuiltinScenes();
  return std::ranges::find(all, name) != all.end();
}

}  // namespace

std::shared_ptr<CompiledScene> CompileEnvScene(const EnvConfig& config) {
  SceneSpec spec = EnvSceneSpec(config);
  if (config.saved_scene.empty()) {
    try {
      return CompileScene(spec);
    } catch (const Error&) {
      if (spec.objects.size() == CountOfObjects(config)) throw;
      // Objects of the task may be the reason: the error is the same then, with their place.
      spec.locations = LocateScene(config, PlaceOfPrepare(config), spec.objects.size());
      return CompileScene(spec);
    }
  }
  return internal::CompileSavedScene(spec,
                                     std::filesystem::path(config.source_dir) / config.saved_scene);
}

std::string MountedGripperName(const std::string& robot) { return "gripper" + robot; }

SceneSpec EnvSceneSpec(const EnvConfig& config) {
  RequireValid(config, "environment '" + config.name + "'");
  SceneSpec scene{.name = config.name,
                  .base = config.scene,
                  .timestep = config.sim.timestep,
                  .add_floor = config.has_added_floor(),
                  .add_skybox = IsBuiltinScene(config.scene),
                  .options = config.options,
                  .root_frame_to_world = config.root_frame_to_world,
                  .shared_base_frame_to_root_frame = config.shared_base_frame_to_root_frame,
                  .source_dir = config.source_dir};
  AddRobots(config, scene);
  AddObjects(config.root_frame_objects, Root(), scene);
  AddObjects(config.world_frame_objects, World(), scene);
  for (const auto& [robot, objects] : config.robot_frame_objects.entries())
    AddObjects(*objects, Attachment(robot), scene);
  AddCameras(config, scene);
  scene.locations = LocateScene(config);
  if (config.randomize && config.randomize->needs_studio()) internal::AddStudio(scene);
  PrepareTask(config, scene);
  return scene;
}

}  // namespace robocell
