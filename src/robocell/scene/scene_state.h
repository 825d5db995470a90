// Private to scene: the state that handles of a Scene share.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "robocell/scene/pool.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/step_gate.h"

namespace robocell {

struct Scene::State {
  explicit State(const std::string& scene)
      : context("scene '" + scene + "'"), name(scene), use(context) {}

  // Read in every tick, so kept together.
  SceneNow now;
  // Time of the data when poses last agreed with qpos. Every step changes the time, no matter what
  // made it.
  double poses_at = -1;
  const std::string context;  // "scene 'pick'", for messages

  const std::string name;
  SceneUse use;
  std::shared_ptr<CompiledScene> compiled;
  DataHandle data;
  DataFactory factory;
  std::map<int, ResetHook> hooks;  // hooks by id, called in order of adding
  int next_hook = 0;
  bool in_hooks = false;  // a reset is calling them
  struct Watch {
    std::string key;
    std::weak_ptr<SceneObserver> observer;
  };
  std::vector<Watch> observers;
  std::weak_ptr<internal::StepGate> gate;
  std::vector<std::weak_ptr<internal::StepLink>> links;
  std::weak_ptr<Kept> kept;     // shared by all handles but inner ones
  std::shared_ptr<void> claim;  // claim on the compiled scene
  int solver = 0;               // the model's, when it was last looked at
  bool closed = false;
  std::vector<internal::PooledObject> pool;
  uint64_t states_set = 0;
  std::map<std::string, uint64_t> mocap_puts;  // puts by body
  std::vector<mjtNum> warm_start;              // scratch

  // Call it after the compiled scene and the data were set.
  void Show();
  // Warns if other code gave the model a solver that is known to be wrong (engine_defects.h) after
  // it was compiled with another one.
  void LookAtSolver() {
    if (now.model->opt.solver != solver) WarnOfSolver();
  }
  void WarnOfSolver();
  // Makes up to n steps, each with the consent of the gate, if there is one, and of the links.
  StepResult StepThrough(internal::StepGate* gate, int n);
  void BindPool();
  internal::PooledObject* FindPooled(const std::string& object);
  // Resets the pool to the spec.
  void ResetPool();
  // Adapts the pool to these positions.
  void FollowPool(const mjtNum* qpos);
  // Throws ArgumentError unless the named body of the scene is free or mocap, NotFoundError if
  // there is none; with the present pool, or that after a reset.
  int RequireMovable(const std::string& body, bool after_reset = false) const;
  // Puts a body of RequireMovable at rest; poses are not brought up to date.
  void PutBody(int body, const Pose& pose_in_world);
  void MoveBaseTarget(int body, const Pose& pose_in_world);
  void PutMocapBody(int body, const Pose& pose_in_world);
  // Skips missing bodies: a hook that ended a reset with an error may have removed some before.
  void PutBodies(const BodyPoses& poses);
  // The parts of a reset: the state with the home noise and the bodies' poses; the hooks; robots
  // and other observers, stale forces, poses.
  ResetInfo RestoreStart(Scene& scene, const ResetOptions& options);
  void CallResetHooks(Scene& scene, const ResetOptions& options, const ResetInfo& info);
  void FinishReset(Scene& scene);
  // Compiles the scene with its present objects and without a pool, for files.
  std::shared_ptr<CompiledScene> WithoutPool();
  // Throws Error that an object cannot be `what`.
  void RequireOwnModel(const char* what, const std::string& object) const;
  const mjModel* model() const { return compiled->model(); }
};

}  // namespace robocell
