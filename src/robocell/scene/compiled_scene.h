// CompiledScene: the model made from a SceneSpec, with its names, its generation and the decisions
// made while compiling. It knows nothing of time or tasks. By default a Scene owns one; Freeze()
// makes it shareable between scenes and threads, after which writes to the model are rejected.
//
//   std::shared_ptr<CompiledScene> compiled = CompileScene(spec);
//   compiled->Freeze();
//   Scene a = Scene::FromCompiled(compiled), b = Scene::FromCompiled(compiled);
//
// Without Freeze(), scenes may use one model one after the other. Changes by the user stay; the
// pool (SceneObject::parked) and the control modes are reset for each scene.
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

// The result of compiling one RobotSpec. Names are full names in the model.
struct RobotRecord {
  std::string name;  // resolved name: RobotSpec.name, else the prefix, else robot, robot_1, ...
  std::string prefix;
  RobotConfig config;  // includes the file's edits; empty for a robot without configuration
  BaseConfig base;
  std::string top_body;                   // the highest body of the robot: its base, or its root
  std::string root_body;                  // its frame is the robot base frame
  std::optional<std::string> mocap_body;  // body at the pedestal's bottom; only for a mocap base
  double pedestal_height = 0;             // height from the mocap body to the root's mount, metres
  std::optional<std::string> attachment_site;
  std::optional<std::string>
      tcp_site;  // site made for attachment_site * tcp_offset, if both are configured
  // The body that the robot stands on, pedestal included: the body made for a base that is not
  // fixed or for a pedestal, else the topmost body of the robot's model. Its subtree is the robot.
  std::string base_body = {};

  // Return the mocap body to which a driven base_body is welded, and the weld.
  std::string base_target() const { return prefix + "base_target"; }
  std::string base_weld() const { return prefix + "base_weld"; }
};

// An active object of the pool; a parked one has none of these values.
struct PoolRecord {
  bool parked = false;                         // after a reset
  std::vector<int> contype, conaffinity = {};  // masks of its geoms
  std::vector<double> gravcomp = {};           // gravcomp of its bodies
};

struct ObjectRecord {
  std::string name;
  std::string root_body;
  std::optional<std::string> free_joint;  // free joint; unset if fixed
  std::optional<PoolRecord> pool = {};    // unset if adding and removing it compiles the scene
};

namespace internal {
class SceneCompiler;
}

// Shared by its scenes, and by Python without a reference to a Python object: a scene may be
// destroyed on any thread.
class CompiledScene : public std::enable_shared_from_this<CompiledScene> {
 public:
  ~CompiledScene();
  CompiledScene(const CompiledScene&) = delete;
  CompiledScene& operator=(const CompiledScene&) = delete;

  const mjModel* model() const { return model_; }
  // Returns the model for writing: control modes, randomisation, the user's changes. Throws Error
  // if frozen.
  mjModel* mutable_model();
  // Returns the editable description that the model came from (for saving), which copies share. A
  // scene from the cache compiles it at the first call, with the errors of CompileScene; call it
  // from one thread at a time.
  mjSpec* mutable_spec();

  const SceneSpec& spec() const { return scene_spec_; }
  const std::vector<RobotRecord>& robots() const { return robots_; }
  const std::vector<ObjectRecord>& objects() const { return objects_; }
  // Throws NotFoundError with the nearest names.
  const RobotRecord& robot(const std::string& name) const;
  const ObjectRecord& object(const std::string& name) const;

  // Grows with every rebuild of a scene; handles compare it to detect that they must look their
  // names up again.
  uint64_t generation() const { return generation_; }
  // Freezes the model. Changes that a destroyed scene left in it (objects of the pool that came or
  // went, control modes) are undone first. Throws Error while a scene lives whose model has such
  // changes.
  void Freeze();
  // Returns the scene with a copy of the model, which is not compiled again: for scenes that write
  // to their model. It has its own generation and is not frozen. For saving it uses the original's
  // spec.
  std::shared_ptr<CompiledScene> Copy();
  bool frozen() const { return frozen_; }
  // Claims a scene's right to use the model, which is given up by destroying the result. Throws
  // Error if another scene has it and the model is not frozen, because writes of one scene to the
  // model would affect the other. Restores the pool and the control modes to the state that the
  // first scene found.
  std::shared_ptr<void> Claim();
  // Returns the settings that parts specified and did not get, and the engine's own warnings from
  // compiling.
  const std::vector<std::string>& warnings() const { return warnings_; }
  // Returns remarks that need no change, such as lights of a robot's file that are left out.
  const std::vector<std::string>& notes() const { return notes_; }
  // Returns the guards against defects of the engine that the model was compiled with, by their
  // names in KnownEngineDefects: {"sparse_newton"} if its Jacobian was made dense, and still is.
  std::vector<std::string> engine_guards() const;
  // Restores the Jacobian that was compiled here, after the options of another scene's model were
  // copied, unless other code wrote another one to that model.
  void KeepJacobian(const CompiledScene& from);
  // Model key with the robots' home positions: qpos0 with each robot's home and the controls that
  // hold it.
  int home_key() const { return home_key_; }

  // The owner of each key of the model, and the key's name in the owner's file; `home` has no
  // owner.
  struct KeyOwner {
    std::string part, name;
  };
  const std::vector<KeyOwner>& key_owners() const { return key_owners_; }

  // Transfers the model's ownership, once: `keeper` keeps the model alive from now on. The Python
  // bindings use it when mujoco.MjModel takes the pointer over. Throws Error if called twice.
  void AdoptModelKeeper(std::shared_ptr<void> keeper);
  // Called after a transfer that failed and freed the model: uses of the model then throw Error.
  void LoseModel();
  bool model_is_external() const { return keeper_ != nullptr; }
  // Throws Error if a file of this and `next`, the scene after an object was added or removed,
  // changed between their compilations: existing objects would change.
  void RequireSameFiles(const CompiledScene& next) const;
  const std::shared_ptr<void>& model_keeper() const { return keeper_; }

 private:
  friend class internal::SceneCompiler;
  friend class SceneCacheEntry;
  // Returns a number that no compiled scene of this process had.
  static uint64_t NextGeneration();
  CompiledScene() = default;
  void RequireModel() const;
  // Returns the changes that scenes make to the model, not their users: the pool and the modes.
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
  std::shared_ptr<CompiledScene> origin_;  // the copied scene, if this is a copy
  std::weak_ptr<void> claim_;
  int jacobian_ = 0;          // opt.jacobian as compiled
  std::optional<int> modes_;  // opt.disableactuator at the first claim
};

// Builds the model. Throws SpecError with all problems of the spec, NotFoundError with missing
// names and files, and EngineError with the engine's message if the model does not compile.
std::shared_ptr<CompiledScene> CompileScene(const SceneSpec& spec);

}  // namespace robocell
