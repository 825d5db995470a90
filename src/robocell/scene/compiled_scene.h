// CompiledScene: the model made from a SceneSpec, with its names, its generation and what was
// decided while compiling. Knows nothing of time or tasks. By default a Scene owns one; Freeze()
// makes it shareable between scenes and threads, after which writes to the model are refused.
//
//   std::shared_ptr<CompiledScene> compiled = CompileScene(spec);
//   compiled->Freeze();
//   Scene a = Scene::FromCompiled(compiled), b = Scene::FromCompiled(compiled);
//
// Without Freeze() scenes may follow each other on one model. What the user writes to it stays; the
// pool (SceneObject::parked) and the control modes begin anew with each.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/mujoco/owners.h"
#include "robocell/scene/source_files.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

// What became of one RobotSpec. Names are full names in the model.
struct RobotRecord {
  std::string name;  // as resolved: RobotSpec.name, else the prefix, else robot, robot_1, ...
  std::string prefix;
  RobotConfig config;  // with the file's edits; a robot without configuration has an empty one
  BaseConfig base;
  std::string top_body;                   // the highest body of the robot: its base, or its root
  std::string root_body;                  // its frame is the robot base frame
  std::optional<std::string> mocap_body;  // at the pedestal's bottom; only with a mocap base
  double pedestal_height = 0;             // from the mocap body to the root body's mount, metres
  std::optional<std::string> attachment_site;
  std::optional<std::string>
      tcp_site;  // site made for attachment_site * tcp_offset, when both are configured
  // What the robot stands on, pedestal included: the body made for a base that is not fixed or
  // for a pedestal, else the topmost body of the robot's model. Its subtree is the robot.
  std::string base_body = {};

  // Of a driven base: the mocap body that base_body is welded to, and the weld.
  std::string base_target() const { return prefix + "base_target"; }
  std::string base_weld() const { return prefix + "base_weld"; }
};

// An object of the pool as it is inside of the scene; what is parked has none of it.
struct PoolRecord {
  bool parked = false;                         // after a reset
  std::vector<int> contype, conaffinity = {};  // of its geoms
  std::vector<double> gravcomp = {};           // of its bodies
};

struct ObjectRecord {
  std::string name;
  std::string root_body;
  std::optional<std::string> free_joint;  // unless it is fixed
  std::optional<PoolRecord> pool = {};    // unless it comes and goes by compiling
};

namespace internal {
class SceneCompiler;
}

// Shared by its scenes, and by Python without a reference to a Python object: a scene may die on
// any thread.
class CompiledScene : public std::enable_shared_from_this<CompiledScene> {
 public:
  ~CompiledScene();
  CompiledScene(const CompiledScene&) = delete;
  CompiledScene& operator=(const CompiledScene&) = delete;

  const mjModel* model() const { return model_; }
  // For control modes, randomisation and the user's own changes. Error when frozen.
  mjModel* mutable_model();
  // The editable description that the model came from (for saving), which copies share. A scene
  // that came from the cache compiles it at the first call, with the errors of CompileScene; one
  // thread at a time.
  mjSpec* mutable_spec();

  const SceneSpec& spec() const { return scene_spec_; }
  const std::vector<RobotRecord>& robots() const { return robots_; }
  const std::vector<ObjectRecord>& objects() const { return objects_; }
  // NotFoundError with the nearest names.
  const RobotRecord& robot(const std::string& name) const;
  const ObjectRecord& object(const std::string& name) const;

  // Grows with every rebuild of a scene; handles compare it to know that they must look their names
  // up again.
  uint64_t generation() const { return generation_; }
  // What a scene that is gone left in the model (objects of the pool that came or went, control
  // modes) is undone before. Error while a scene lives whose model differs so.
  void Freeze();
  // The same with a model of its own, copied and not compiled: for scenes that write to theirs. It
  // has a generation of its own and is not frozen. The spec, for saving, is this one's.
  std::shared_ptr<CompiledScene> Copy();
  bool frozen() const { return frozen_; }
  // A scene's right to use the model, given up by destroying it. Error if another scene has it and
  // the model is not frozen, because writes of one scene to the model would affect the other. The
  // pool and the control modes are as the first scene found them.
  std::shared_ptr<void> Claim();
  // What the parts asked for and did not get, and the engine's own warnings from compiling.
  const std::vector<std::string>& warnings() const { return warnings_; }
  // What is good to know and needs no change, such as lights of a robot's file that stay behind.
  const std::vector<std::string>& notes() const { return notes_; }
  // Guards against defects of the engine that the model was compiled with, by their names in
  // KnownEngineDefects: {"sparse_newton"} when its Jacobian was made dense, and still is.
  std::vector<std::string> engine_guards() const;
  // After the options of another scene's model were copied to this one's: puts the Jacobian back
  // that was compiled here, unless somebody wrote another one to that model.
  void KeepJacobian(const CompiledScene& from);
  // Model key with the robots' home positions: qpos0 with each robot's home and the controls that
  // hold it.
  int home_key() const { return home_key_; }

  // Whose keyframe each key of the model is, and how its file calls it; of `home` nobody's.
  struct KeyOwner {
    std::string part, name;
  };
  const std::vector<KeyOwner>& key_owners() const { return key_owners_; }

  // Hands the model's ownership to somebody else, once: `keeper` keeps the model alive from now on.
  // Used by the Python bindings, where mujoco.MjModel takes the pointer over. Calling it twice is
  // an Error.
  void AdoptModelKeeper(std::shared_ptr<void> keeper);
  // After a hand-over that failed and freed the model: what needs it from now on is an Error.
  void LoseModel();
  bool model_is_external() const { return keeper_ != nullptr; }
  // Raises an Error if a file of this and `next`, the scene with an object more or less, was
  // changed between their compilations: existing objects would change.
  void RequireSameFiles(const CompiledScene& next) const;
  const std::shared_ptr<void>& model_keeper() const { return keeper_; }

 private:
  friend class internal::SceneCompiler;
  friend class SceneCacheEntry;
  // A number that no compiled scene of this process had.
  static uint64_t NextGeneration();
  CompiledScene() = default;
  void RequireModel() const;
  // Of what scenes write to the model by themselves, not its users: the pool and the modes.
  std::vector<std::string> DifferencesFromStart() const;
  void RestoreStart();

  SceneSpec scene_spec_;
  SpecPtr spec_owner_;
  ModelPtr model_owner_;
  std::shared_ptr<void> keeper_;
  mjModel* model_ = nullptr;
  std::vector<RobotRecord> robots_;
  std::vector<ObjectRecord> objects_;
  std::vector<std::string> warnings_, notes_, engine_guards_;
  uint64_t generation_ = 0;
  int home_key_ = -1;
  std::vector<KeyOwner> key_owners_;
  bool frozen_ = false;
  SourceFiles sources_;
  std::shared_ptr<CompiledScene> origin_;  // of a copy
  std::weak_ptr<void> claim_;
  int jacobian_ = 0;          // opt.jacobian as compiled
  std::optional<int> modes_;  // opt.disableactuator as the first scene found it
};

// Builds the model. SpecError contains all problems of the spec, NotFoundError missing names and
// files, EngineError the engine's message if the model does not compile.
std::shared_ptr<CompiledScene> CompileScene(const SceneSpec& spec);

}  // namespace robocell
