// Scene: a simulation that is alive: one mjData on a CompiledScene. A Scene is a handle to shared
// state and cheap to copy; the state lives as long as any handle to it.
//
// Poses are world poses of the named element. Lengths in metres, time in seconds, quaternions xyzw.
// After any change to qpos through this class the poses are up to date; code that writes data()
// itself calls Forward().
//
//   Scene scene = Scene::Build(spec);
//   scene.Reset({.seed = 1});
//   for (int i = 0; i < 500; ++i) scene.Step();
//   Pose cube = scene.body_pose("cube");
//
// Errors: NotFoundError for unknown names, ClosedError after Close(), EngineError when MuJoCo
// reports one. Divergence is a value (StepResult), never an exception. One scene is used by one
// thread at a time; use() is how callers who do not know of each other keep to that.
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

// A keyframe of the scene: its number, its full name ("left_retract", with the prefix of its part),
// the keyframe of one part's own model ("left: retract"), or those of robots and objects by their
// names: {{"left", "retract"}, {"right", "ready"}}. What is not named there is at home.
using KeyframeChoice = std::variant<int, std::string, std::map<std::string, std::string>>;

struct ResetOptions {
  std::optional<KeyframeChoice> keyframe = {};  // unset: the scene's home key
  bool use_keyframe = true;                     // false: the model's default configuration
  std::optional<uint64_t> seed = {};            // for home_noise; unset: no noise
  // Free and mocap bodies that start elsewhere, at rest, whatever hooks do to them. Moved one by
  // one after the reset, each costs a Forward() more.
  BodyPoses body_poses = {};
};

struct ResetInfo {
  bool used_keyframe = false;
  int keyframe = -1;  // its number; home's when robots were given keyframes of their own
};

// What a reset hook gets. It may write the state; ports are re-seeded from what it leaves.
struct ResetContext {
  Scene& scene;
  const ResetOptions& options;
  const ResetInfo& info;
};

using ResetHook = std::function<void(ResetContext&)>;

// Told about what happens to a scene. Robots use it to follow resets and rebuilds.
class SceneObserver {
 public:
  virtual ~SceneObserver() = default;
  // What one of these two throws comes out of Reset(), the first of them, after all others were
  // told and the reset was carried out.
  virtual void OnReset() {}  // after the reset hook; poses agree with qpos
  // After the Forward() that ends a reset: forces and sensors agree with the state too.
  virtual void OnResetDone() {}
  // After each Forward(), that of a reset too: the time to look for what somebody wrote into the
  // model. It is called often, and adds no observers.
  virtual void OnForward() {}
  // Called after objects were added or removed: model and data are new, look names up again. An
  // exception undoes the change; observers that were called already are called again with the old
  // model.
  virtual void OnRebuild() {}
  virtual void OnClose() {}
};

// Data on a model and what keeps it alive. The default makes it with mj_makeData; Python makes its
// own.
struct DataHandle {
  mjData* data = nullptr;
  std::shared_ptr<void> keeper;
};
using DataFactory = std::function<DataHandle(CompiledScene&)>;

// A scene's present model and data, for handles that look at them in every tick.
struct SceneNow {
  const mjModel* model = nullptr;
  mjData* data = nullptr;  // null once the scene was closed
  uint64_t generation = 0;
};

struct Contact {
  std::string geom1, geom2;  // full names, or "body/geom#i" when unnamed
  std::string body1, body2;
  double distance;           // negative when penetrating, metres
  Eigen::Vector3d position;  // in the world
  Eigen::Vector3d force;     // on body2, in the world, N
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
  // Recomputes everything that follows from qpos, qvel and ctrl, and from what was written to the
  // model: robots' chains too.
  void Forward();

  // An engine step leaves poses (xpos, site_xpos, cameras) one step behind qpos.
  // This brings them up to date: about a microsecond after a step, nothing otherwise; physics is
  // not affected. The pose functions below and all handles (move groups, cameras) call it first.
  void SyncPoses() const;
  // To be called after writing qpos without Forward(): poses are computed anew when next asked for.
  void PosesChanged();

  // Restores the keyframe (or default), puts robots at home plus noise and bodies where the options
  // say, calls the hooks and the observers, clears stale forces and warm starts, and runs Forward.
  // The trajectory after a reset does not depend on anything before. A body that does not exist or
  // cannot be moved is an error before anything changes.
  ResetInfo Reset(const ResetOptions& options = {});
  // Names of the keyframes by their numbers: "home", then those of the parts' own models, each with
  // its part's prefix.
  std::vector<std::string> keyframes() const;
  int AddResetHook(ResetHook hook);
  void RemoveResetHook(int id);
  void ClearResetHooks();
  // Observers are held weakly, but for those that the scene keeps: they live as long as any handle
  // to the scene and can be found again by their key, so that a robot has one state. What is kept
  // holds the scene by inner(), else both live until Close().
  void AddObserver(std::weak_ptr<SceneObserver> observer, const std::string& key = {});
  void KeepObserver(std::shared_ptr<SceneObserver> observer, const std::string& key);
  std::shared_ptr<SceneObserver> FindObserver(const std::string& key) const;
  // Those whose keys begin so, in the order in which they were added.
  std::vector<std::shared_ptr<SceneObserver>> FindObservers(std::string_view key_begin) const;
  // A handle that keeps the simulation alive, but not what the scene keeps.
  Scene inner() const;

  // Adds an object to the running scene, or takes one away, by compiling its spec with the object
  // more or less. Everything else goes on as it was, to the bit: state, time, controls, applied
  // forces and what was written to the model, but for the few fields of the model that
  // docs/scenes.md names (what mj_setConst derives, keyframes, integers, meshes and the like).
  // Handles follow by name; model() and data() are new, pointers to the old ones end here. The new
  // object stands where a reset would put it; spec(), saved files and later resets have it. An
  // error (bad object, name taken, unknown name, something is attached to the object, frozen model)
  // leaves the scene as it was.
  //
  // Objects of the pool (SceneObject::parked) come and go within microseconds: nothing is compiled,
  // handles and pointers stay. They can be added by name, with the pose of their root body in the
  // world unless it is the spec's. No allocation. A reset puts the pool back as the spec says.
  void AddObject(const SceneObject& object);
  void AddObject(const std::string& name, const std::optional<Pose>& pose_in_world = {});
  void RemoveObject(const std::string& name);
  std::vector<std::string> object_names() const;    // of those that are there now
  std::vector<std::string> parked_objects() const;  // of those of the pool that are not

  // Frames, in the world.
  Pose body_pose(const std::string& name) const;
  Pose site_pose(const std::string& name) const;
  Pose camera_pose(const std::string& name) const;  // MuJoCo camera axes
  // Moves a free or mocap body and stops it; an error for any other body.
  void SetBodyPose(const std::string& name, const Pose& pose_in_world);
  // How often a mocap body of that name was put elsewhere so far, also with the driven base that
  // follows it, and by SetState. Who moves one in every tick knows by it that it has to start anew.
  uint64_t times_put(const std::string& mocap_body) const;
  Pose root_frame_to_world() const;
  Pose shared_base_frame_to_world() const;

  std::vector<std::string> body_names() const;
  std::vector<std::string> joint_names() const;
  std::vector<std::string> camera_names() const;

  // Of a hinge (rad) or slide (m), whoever's it is, as it stands in data().qpos; an ArgumentError
  // for free and ball joints.
  double joint_pos(const std::string& name) const;

  bool has_actuator(const std::string& name) const;
  // An ArgumentError for an actuator of several inputs, which says where its controls stand.
  double actuator_ctrl(const std::string& name) const;
  // Refuses NaN by name before the engine sees it.
  void SetActuatorCtrl(const std::string& name, double value);
  // Force (N) and torque (Nm) on a body in the world, at its centre of mass, kept until changed or
  // reset. An ArgumentError for the world and for parked objects.
  void SetBodyWrench(const std::string& body, const Eigen::Vector3d& force,
                     const Eigen::Vector3d& torque = Eigen::Vector3d::Zero());

  // Active contacts, with `of` those of that body's subtree, as the last step or Forward found
  // them: places and forces belong to the state before that step. SyncPoses does not look for
  // contacts anew; Forward does.
  std::vector<Contact> contacts(const std::string& of = "") const;

  // Everything the engine needs to go on bit-equally (mjSTATE_INTEGRATION).
  std::vector<double> state() const;
  // ArgumentError for a state of another size, or that is not finite: it says which number of what.
  void SetState(std::span<const double> state);

  // Files that stock MuJoCo loads. The XML refers to assets by absolute path.
  void SaveXml(const std::string& path) const;
  void SaveBinary(const std::string& path) const;
  std::string ToXml() const;

  const std::string& name() const;
  const SceneSpec& spec() const;
  const std::shared_ptr<CompiledScene>& compiled() const;
  uint64_t generation() const { return now().generation; }
  const mjModel* model() const { return now().model; }
  mjModel* mutable_model();  // Error when the compiled scene is frozen
  mjData* data() const { return now().data; }
  const SceneNow& now() const {
    if (closed()) ThrowClosed();
    return *now_;
  }
  const std::shared_ptr<void>& data_keeper() const;

  // For claims by those who use it, also after it was closed; handles to one simulation share it.
  SceneUse& use() const;

  void Close();
  bool closed() const { return now_->data == nullptr; }
  // For garbage collectors of other languages: how many handles there are, what the scene holds of
  // theirs, and a number that handles to the same simulation share.
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
  bool RemovePooled(const std::string& name);  // false: it is not of the pool
  void Swap(internal::PooledObject& object, bool park, const double* pos);

  std::shared_ptr<State> state_;
  const SceneNow* now_;         // the state's
  std::shared_ptr<Kept> kept_;  // null in an inner handle
};

// Knows a simulation without keeping it alive. The id of the scene is no other's while this lives.
class Scene::Weak {
 public:
  explicit Weak(const Scene& scene) : state_(scene.state_), kept_(scene.kept_) {}

  // That are no inner() ones; of a scene that is gone none.
  size_t handles() const { return static_cast<size_t>(kept_.use_count()); }
  std::optional<Scene> lock() const;

 private:
  std::weak_ptr<State> state_;
  std::weak_ptr<Kept> kept_;
};

}  // namespace robocell
