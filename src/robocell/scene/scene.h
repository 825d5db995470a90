// Scene: a live simulation: one mjData on a CompiledScene. A Scene is a handle to shared state and
// cheap to copy; the state lives as long as any handle to it.
//
// Poses are world poses of the named element. Lengths are in metres, times in seconds, quaternions
// xyzw. After any change to qpos through this class the poses are up to date; code that writes
// data() itself calls Forward().
//
//   Scene scene = Scene::Build(spec);
//   scene.Reset({.seed = 1});
//   for (int i = 0; i < 500; ++i) scene.Step();
//   Pose cube = scene.body_pose("cube");
//
// Errors: NotFoundError for unknown names, ClosedError after Close(), EngineError for an error of
// MuJoCo. Divergence is a value (StepResult), never an exception. One thread at a time may use a
// scene; callers that do not know of each other ensure that by use().
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/mujoco/step.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/scene_use.h"

namespace robocell {

class Scene;
namespace internal {
class PooledObject;
}

// Bodies by name, each with a pose in the world.
using BodyPoses = std::vector<std::pair<std::string, Pose>>;

// A keyframe of a part's own model: its name, or its number, where 0 is home and the others follow
// in the order of the file.
using PartKeyframe = std::variant<int, std::string>;
using PartKeyframes = std::map<std::string, PartKeyframe>;  // keys: names of robots and objects

// A keyframe of the scene: its number, its full name ("left_retract", with the prefix of its part),
// the keyframe of one part's own model ("left: retract"), or those of robots and objects by their
// names: {{"left", "retract"}, {"right", 1}}. Unnamed parts are at home.
using KeyframeChoice = std::variant<int, std::string, PartKeyframes>;

struct ResetOptions {
  std::optional<KeyframeChoice> keyframe = {};  // unset: the scene's home key
  bool use_keyframe = true;                     // false: the model's default configuration
  std::optional<uint64_t> seed = {};            // seed of home_noise; unset: no noise
  // Free and mocap bodies that start elsewhere, at rest; they override hooks. Moving them one
  // by one after the reset would cost a Forward() each.
  BodyPoses body_poses = {};
};

struct ResetInfo {
  bool used_keyframe = false;
  int keyframe = -1;  // its number; that of home if robots have their own keyframes
};

// The argument of a reset hook. A hook may write the state; ports are re-seeded from the result.
struct ResetContext {
  Scene& scene;
  const ResetOptions& options;
  const ResetInfo& info;
};

using ResetHook = std::function<void(ResetContext&)>;

// Notified of events of a scene. Robots use it to follow resets and rebuilds.
class SceneObserver {
 public:
  virtual ~SceneObserver() = default;
  // The first exception of these two functions is rethrown by Reset(), after all other observers
  // were notified and the reset was completed.
  virtual void OnReset() {}  // after the reset hook; poses agree with qpos
  // Called after the Forward() that ends a reset: forces and sensors agree with the state too.
  virtual void OnResetDone() {}
  // Called after each Forward(), including that of a reset: the time to check for values written
  // into the model. It is called often, and must not add observers.
  virtual void OnForward() {}
  // Called after objects were added or removed: model and data are new, look names up again. An
  // exception undoes the change; observers that were called already are called again with the old
  // model.
  virtual void OnRebuild() {}
  virtual void OnClose() {}
};

// Data on a model and its owner. The default makes it with mj_makeData; Python makes its own.
struct DataHandle {
  mjData* data = nullptr;
  std::shared_ptr<void> keeper;
};
using DataFactory = std::function<DataHandle(CompiledScene&)>;

// A scene's present model and data, for handles that read them in every tick.
struct SceneNow {
  const mjModel* model = nullptr;
  mjData* data = nullptr;  // null after the scene was closed
  uint64_t generation = 0;
};

struct Contact {
  std::string geom1, geom2;  // full names, or "body/geom#i" when unnamed
  std::string body1, body2;
  double distance;           // negative when penetrating, metres
  Eigen::Vector3d position;  // contact point in the world
  Eigen::Vector3d force;     // force on body2 in the world, N
};

class Scene {
 public:
  static Scene Build(const SceneSpec& spec, const DataFactory& factory = {});
  static Scene FromCompiled(std::shared_ptr<CompiledScene> compiled,
                            const DataFactory& factory = {});

  // Time and stepping. No allocation.
  double time() const;
  double timestep() const;
  StepResult Step() { return StepN(1); }
  StepResult StepN(int n);
  // Recomputes everything that follows from qpos, qvel and ctrl, and from values written to the
  // model, including robots' chains.
  void Forward();

  // An engine step leaves poses (xpos, site_xpos, cameras) one step behind qpos. This brings them
  // up to date: about a microsecond after a step, nothing otherwise; physics is not affected. The
  // pose functions below and all handles (move groups, cameras) call it first.
  void SyncPoses() const;
  // Call it after writing qpos without Forward(): poses are then recomputed on demand.
  void PosesChanged();

  // Restores the keyframe (or default), puts robots at home plus noise and bodies at the given
  // poses, calls the hooks and the observers, clears stale forces and warm starts, and runs
  // Forward. The trajectory after a reset does not depend on anything before. A body that does not
  // exist or cannot be moved is an error before anything changes.
  ResetInfo Reset(const ResetOptions& options = {});
  // Returns the names of the keyframes by their numbers: "home", then those of the parts' own
  // models, each with its part's prefix.
  std::vector<std::string> keyframes() const;
  int AddResetHook(ResetHook hook);
  void RemoveResetHook(int id);
  void ClearResetHooks();
  // Observers are held weakly, except those that the scene keeps: they live as long as any handle
  // to the scene and can be found again by their key, so that a robot has one state. A kept
  // observer holds the scene by inner(), or else both live until Close(). Throws Error when only
  // inner() handles are left.
  void AddObserver(std::weak_ptr<SceneObserver> observer, const std::string& key = {});
  void KeepObserver(std::shared_ptr<SceneObserver> observer, const std::string& key);
  std::shared_ptr<SceneObserver> FindObserver(const std::string& key) const;
  // Returns those whose keys begin with `key_begin`, in the order of adding.
  std::vector<std::shared_ptr<SceneObserver>> FindObservers(std::string_view key_begin) const;
  // Returns a handle that keeps the simulation alive, but not the kept observers. Parts of an
  // object that has a handle hold the scene by it: then the object counts as one handle.
  Scene inner() const;
  // Returns a handle like any other, for code that may keep it; an inner() one if only such are
  // left.
  Scene outer() const;

  // Adds or removes an object of the running scene, by compiling the changed spec. Everything else
  // continues to the bit: state, time, controls, applied forces and values written to the model,
  // except the few fields of the model that docs/scenes.md names (what mj_setConst derives,
  // keyframes, integers, meshes and the like). Handles follow by name; model() and data() are new,
  // and pointers to the old ones become invalid. The new object is at its place after a reset;
  // spec(), saved files and later resets contain it. An error (bad object, name taken, unknown
  // name, something is attached to the object, frozen model) leaves the scene unchanged.
  //
  // Objects of the pool (SceneObject::parked) are added and removed within microseconds: nothing is
  // compiled, and handles and pointers stay valid. They can be added by name, with the pose of
  // their root body in the world unless it is the spec's. No allocation. A reset restores the pool
  // of the spec.
  void AddObject(const SceneObject& object);
  void AddObject(const std::string& name, const std::optional<Pose>& pose_in_world = {});
  void RemoveObject(const std::string& name);
  std::vector<std::string> object_names() const;    // present objects
  std::vector<std::string> parked_objects() const;  // absent objects of the pool

  // Frames, in the world.
  Pose body_pose(const std::string& name) const;
  Pose site_pose(const std::string& name) const;
  Pose camera_pose(const std::string& name) const;  // MuJoCo camera axes
  // Moves a free or mocap body and stops it; an error for any other body.
  void SetBodyPose(const std::string& name, const Pose& pose_in_world);
  // Returns how often a mocap body was moved so far, also with the driven base that follows it, and
  // by SetState. Code that moves it in every tick detects by this that it has to restart.
  uint64_t times_put(const std::string& mocap_body) const;
  Pose root_frame_to_world() const;
  Pose shared_base_frame_to_world() const;

  std::vector<std::string> body_names() const;
  std::vector<std::string> joint_names() const;
  std::vector<std::string> camera_names() const;

  // Returns the position of a hinge (rad) or slide (m) of any owner, as in data().qpos. Throws
  // ArgumentError for free and ball joints.
  double joint_pos(const std::string& name) const;

  bool has_actuator(const std::string& name) const;
  // Throws ArgumentError, with the place of its controls, for an actuator with several inputs.
  double actuator_ctrl(const std::string& name) const;
  // Rejects NaN by name before the engine sees it.
  void SetActuatorCtrl(const std::string& name, double value);
  // Applies a force (N) and torque (Nm) to a body in the world, at its centre of mass, kept until
  // changed or reset. Throws ArgumentError for the world and for parked objects.
  void SetBodyWrench(const std::string& body, const Eigen::Vector3d& force,
                     const Eigen::Vector3d& torque = Eigen::Vector3d::Zero());

  // Returns active contacts, with `of` those of that body's subtree, as computed by the last step
  // or Forward: places and forces belong to the state before that step. Only Forward computes
  // contacts too, SyncPoses does not.
  std::vector<Contact> contacts(const std::string& of = "") const;

  // Returns everything the engine needs to continue bit-equally (mjSTATE_INTEGRATION).
  std::vector<double> state() const;
  // Throws ArgumentError for a state of another size, or for a number that is not finite, which the
  // message identifies.
  void SetState(std::span<const double> state);

  // Saves files that stock MuJoCo loads. The XML refers to assets by absolute path.
  void SaveXml(const std::string& path) const;
  void SaveBinary(const std::string& path) const;
  std::string ToXml() const;

  const std::string& name() const;
  const SceneSpec& spec() const;
  const std::shared_ptr<CompiledScene>& compiled() const;
  uint64_t generation() const { return now().generation; }
  const mjModel* model() const { return now().model; }
  mjModel* mutable_model();  // throws Error if the compiled scene is frozen
  mjData* data() const { return now().data; }
  const SceneNow& now() const {
    if (closed()) ThrowClosed();
    return *now_;
  }
  const std::shared_ptr<void>& data_keeper() const;

  // Returns the claim of the simulation, also after it was closed; handles to one simulation share
  // it.
  SceneUse& use() const;

  void Close();
  bool closed() const { return now_->data == nullptr; }
  // Access for garbage collectors of other languages: the number of handles (Weak), the foreign
  // objects that the scene holds, and an id that handles to one simulation share.
  class Weak;
  const std::map<int, ResetHook>& reset_hooks() const;
  const std::vector<std::shared_ptr<SceneObserver>>& kept_observers() const;
  void ForgetKeptObservers();
  size_t id() const { return reinterpret_cast<size_t>(state_.get()); }

  // Handles to the same simulation are equal.
  bool operator==(const Scene& other) const { return state_ == other.state_; }

 private:
  struct State;
  using Kept = std::vector<std::shared_ptr<SceneObserver>>;
  Scene(std::shared_ptr<State> state, std::shared_ptr<Kept> kept);
  State& open() const;
  [[noreturn]] void ThrowClosed() const;
  void Rebuild(const SceneSpec& spec);
  void AddPooled(const SceneObject& object);
  bool RemovePooled(const std::string& name);  // false: it does not belong to the pool
  void Swap(internal::PooledObject& object, bool park, const double* pos);

  std::shared_ptr<State> state_;
  const SceneNow* now_;         // the state's
  std::shared_ptr<Kept> kept_;  // null in an inner handle
};

// Refers to a simulation without keeping it alive. No other scene gets its id while this lives.
class Scene::Weak {
 public:
  explicit Weak(const Scene& scene);  // accepts an inner handle too

  // Returns the number of handles, without inner() ones; 0 for a destroyed scene.
  size_t handles() const { return static_cast<size_t>(kept_.use_count()); }
  std::optional<Scene> lock() const;

 private:
  std::weak_ptr<State> state_;
  std::weak_ptr<Kept> kept_;
};

}  // namespace robocell
