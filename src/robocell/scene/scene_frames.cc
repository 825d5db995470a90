// Frames, actuators, wrenches and state of a Scene.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/body_put_observer.h"
#include "robocell/scene/scene_state.h"

namespace robocell {
namespace {

// Describes a number of Scene::state(), for messages.

std::string OfPosition(const mjModel* m, int index) {
  int joint = static_cast<int>(m->njnt) - 1;
  while (joint > 0 && m->jnt_qposadr[joint] > index) --joint;
  return "the position of " + Describe(m, mjOBJ_JOINT, joint);
}

std::string OfDof(const mjModel* m, const char* what, int dof) {
  return fmt::format("the {} of {}", what, Describe(m, mjOBJ_JOINT, m->dof_jntid[dof]));
}

std::string OfControl(const mjModel* m, int index) {
  int actuator = static_cast<int>(m->nactuator) - 1;
  while (actuator > 0 && m->actuator_ctrladr[actuator] > index) --actuator;
  return "the control of " + Describe(m, mjOBJ_ACTUATOR, actuator);
}

std::string OfMocap(const mjModel* m, const char* what, int mocap) {
  for (int body = 0; body < m->nbody; ++body) {
    if (m->body_mocapid[body] == mocap)
      return fmt::format("the {} of {}", what, Describe(m, mjOBJ_BODY, body));
  }
  return fmt::format("the {} of mocap body {}", what, mocap);
}

std::string OfPart(const mjModel* m, int part, int index) {
  switch (part) {
    case mjSTATE_TIME:
      return "the time";
    case mjSTATE_QPOS:
      return OfPosition(m, index);
    case mjSTATE_QVEL:
      return OfDof(m, "velocity", index);
    case mjSTATE_WARMSTART:
      return OfDof(m, "warm start", index);
    case mjSTATE_CTRL:
      return OfControl(m, index);
    case mjSTATE_QFRC_APPLIED:
      return OfDof(m, "applied force", index);
    case mjSTATE_XFRC_APPLIED:
      return "the wrench on " + Describe(m, mjOBJ_BODY, index / 6);
    case mjSTATE_MOCAP_POS:
      return OfMocap(m, "position", index / 3);
    case mjSTATE_MOCAP_QUAT:
      return OfMocap(m, "orientation", index / 4);
    case mjSTATE_ACT:
      return fmt::format("number {} of the activations", index);
    default:
      return fmt::format("number {} of what else the engine keeps", index);
  }
}

// Describes the number at `index` of a state (mjSTATE_INTEGRATION) of the model: "the position of
// joint 'elbow'", "the control of actuator 'servo2'", "number 3 of the activations".
std::string DescribeStateNumber(const mjModel* m, size_t index) {
  auto left = static_cast<int>(index);
  for (int bit = 0; bit < mjNSTATE; ++bit) {
    const int part = mjSTATE_INTEGRATION & (1 << bit);
    const int size = part ? static_cast<int>(mj_stateSize(m, part)) : 0;
    if (left < size) return OfPart(m, part, left);
    left -= size;
  }
  return fmt::format("number {}", index);
}

constexpr int kState = mjSTATE_INTEGRATION;

// Wakes all bodies; the state is then set. The engine has no call for it alone, and counts its
// warnings on.
void WakeAll(const mjModel* m, mjData* d) {
  std::array<mjWarningStat, mjNWARNING> warnings;
  std::copy_n(d->warning, mjNWARNING, warnings.begin());
  mj_resetData(m, d);
  std::copy_n(warnings.begin(), mjNWARNING, d->warning);
}

std::vector<std::string> Named(const mjModel* model, mjtObj kind) {
  std::vector<std::string> names = ElementNames(model, kind);
  std::erase(names, "");
  return names;
}

bool IsFree(const mjModel* model, int body) {
  return model->body_jntnum[body] == 1 && model->jnt_type[model->body_jntadr[body]] == mjJNT_FREE;
}

void MoveFreeBody(const mjModel* model, mjData* data, int body, const Pose& pose) {
  const int joint = model->body_jntadr[body];
  mjtNum* q = data->qpos + model->jnt_qposadr[joint];
  pose.ToWxyz(q, q + 3);
  std::fill_n(data->qvel + model->jnt_dofadr[joint], 6, 0.0);
}

void MoveMocapBody(mjData* data, int mocap, const Pose& pose) {
  pose.ToWxyz(data->mocap_pos + 3 * mocap, data->mocap_quat + 4 * mocap);
}

void RequireFinite(double value, const std::string& what) {
  if (!std::isfinite(value))
    throw ArgumentError(fmt::format("{} must be a finite number, got {}", what, value));
}

// Returns the index of an actuator's control.
int RequireOneInput(const mjModel* m, const std::string& actuator, const std::string& context) {
  const int id = RequireId(m, mjOBJ_ACTUATOR, actuator, context);
  const int first = m->actuator_ctrladr[id], count = m->actuator_ctrlnum[id];
  if (count == 1) return first;
  if (count == 0)
    throw ArgumentError(fmt::format("{}: actuator '{}' has no control", context, actuator));
  throw ArgumentError(
      fmt::format("{}: actuator '{}' has {} controls, not one: ctrl[{}] to ctrl[{}], in the order "
                  "of its inputs. Read and write them as data()->ctrl (in Python "
                  "scene.data.ctrl[{}:{}])",
                  context, actuator, count, first, first + count - 1, first, first + count));
}

}  // namespace

Pose Scene::body_pose(const std::string& name) const {
  const State& s = open();
  SyncPoses();
  const int id = RequireId(s.model(), mjOBJ_BODY, name, s.context);
  return Pose::FromWxyz(s.data.data->xpos + 3 * id, s.data.data->xquat + 4 * id);
}

Pose Scene::site_pose(const std::string& name) const {
  const State& s = open();
  SyncPoses();
  const int id = RequireId(s.model(), mjOBJ_SITE, name, s.context);
  return Pose::FromTranslationAndMatrix(s.data.data->site_xpos + 3 * id,
                                        s.data.data->site_xmat + 9 * id);
}

Pose Scene::camera_pose(const std::string& name) const {
  const State& s = open();
  SyncPoses();
  const int id = RequireId(s.model(), mjOBJ_CAMERA, name, s.context);
  return Pose::FromTranslationAndMatrix(s.data.data->cam_xpos + 3 * id,
                                        s.data.data->cam_xmat + 9 * id);
}

int Scene::State::RequireMovable(const std::string& name, bool after_reset) const {
  const int body = RequireId(model(), mjOBJ_BODY, name, context);
  for (const internal::PooledObject& object : pool) {
    const bool parked = after_reset ? object.parked_after_reset() : object.parked;
    if (!parked || object.body() != body) continue;
    if (after_reset) {
      throw ArgumentError(
          fmt::format("{}: a reset parks object '{}', so it cannot start anywhere; put it into the "
                      "scene after the reset, at its pose, with {}",
                      context, object.name(), internal::CppAndPythonName("AddObject")));
    }
    throw ArgumentError(
        fmt::format("{}: object '{}' is parked, so it cannot be moved; put it into the scene at "
                    "its pose with {}",
                    context, object.name(), internal::CppAndPythonName("AddObject")));
  }
  if (model()->body_mocapid[body] >= 0 || IsFree(model(), body)) return body;
  throw ArgumentError(
      fmt::format("{}: body '{}' cannot be moved by its pose: it is neither free nor a mocap body",
                  context, name));
}

void Scene::State::PutBody(int body, const Pose& pose_in_world) {
  if (model()->body_mocapid[body] >= 0) {
    PutMocapBody(body, pose_in_world);
  } else {
    MoveFreeBody(model(), data.data, body, pose_in_world);
    MoveBaseTarget(body, pose_in_world);
  }
}

// A driven base only stays at its new place if the body that it is welded to moves there too.
void Scene::State::MoveBaseTarget(int body, const Pose& pose_in_world) {
  for (const RobotRecord& robot : compiled->robots()) {
    if (robot.base.kind != BaseKind::kDriven ||
        FindId(model(), mjOBJ_BODY, robot.base_body) != body)
      continue;
    const int target = FindId(model(), mjOBJ_BODY, robot.base_target());
    if (target >= 0) PutMocapBody(target, pose_in_world);
  }
}

void Scene::State::PutMocapBody(int body, const Pose& pose_in_world) {
  MoveMocapBody(data.data, model()->body_mocapid[body], pose_in_world);
  ++mocap_puts[ElementName(model(), mjOBJ_BODY, body)];
}

uint64_t Scene::times_put(const std::string& mocap_body) const {
  const State& s = open();
  const auto put = s.mocap_puts.find(mocap_body);
  return s.states_set + (put == s.mocap_puts.end() ? 0 : put->second);
}

void Scene::State::PutBodies(const BodyPoses& poses) {
  for (const auto& [name, pose] : poses) {
    const int body = FindId(model(), mjOBJ_BODY, name);
    if (body >= 0) PutBody(body, pose);
  }
}

void Scene::SetBodyPose(const std::string& name, const Pose& pose_in_world) {
  State& s = open();
  const int body = s.RequireMovable(name);
  for (size_t i = 0; i < s.observers.size(); ++i) {  // a copy would allocate
    const auto observer = s.observers[i].observer.lock();
    if (auto* hears = dynamic_cast<internal::BodyPutObserver*>(observer.get()))
      hears->OnBodyPut(body, pose_in_world);
  }
  s.PutBody(body, pose_in_world);
  Forward();
}

std::vector<std::string> Scene::body_names() const { return Named(open().model(), mjOBJ_BODY); }

std::vector<std::string> Scene::joint_names() const { return Named(open().model(), mjOBJ_JOINT); }

std::vector<std::string> Scene::camera_names() const { return Named(open().model(), mjOBJ_CAMERA); }

double Scene::joint_pos(const std::string& name) const {
  const State& s = open();
  const mjModel* m = s.model();
  const int joint = RequireId(m, mjOBJ_JOINT, name, s.context);
  if (m->jnt_type[joint] == mjJNT_HINGE || m->jnt_type[joint] == mjJNT_SLIDE)
    return s.data.data->qpos[m->jnt_qposadr[joint]];
  throw ArgumentError(fmt::format(
      "{}: joint '{}' is {}, whose position is more than one number; ask for the pose of its body, "
      "body_pose(\"{}\")",
      s.context, name, m->jnt_type[joint] == mjJNT_FREE ? "free" : "a ball joint",
      ElementName(m, mjOBJ_BODY, m->jnt_bodyid[joint])));
}

bool Scene::has_actuator(const std::string& name) const {
  return FindId(open().model(), mjOBJ_ACTUATOR, name) >= 0;
}

double Scene::actuator_ctrl(const std::string& name) const {
  const State& s = open();
  return s.data.data->ctrl[RequireOneInput(s.model(), name, s.context)];
}

void Scene::SetActuatorCtrl(const std::string& name, double value) {
  State& s = open();
  const int input = RequireOneInput(s.model(), name, s.context);
  RequireFinite(value, fmt::format("{}: control of actuator '{}'", s.context, name));
  s.data.data->ctrl[input] = value;
}

void Scene::SetBodyWrench(const std::string& body, const Eigen::Vector3d& force,
                          const Eigen::Vector3d& torque) {
  State& s = open();
  const int id = RequireId(s.model(), mjOBJ_BODY, body, s.context);
  if (id == 0) {
    throw ArgumentError(
        fmt::format("{}: body '{}' cannot be pushed, because it cannot move. Name another body: {}",
                    s.context, body, ListNames(body_names())));
  }
  for (const internal::PooledObject& object : s.pool) {
    if (!object.parked || !internal::IsInSubtree(s.model(), id, object.body())) continue;
    throw ArgumentError(
        fmt::format("{}: object '{}' is parked, so nothing can push it; put it into the scene "
                    "first, with {}",
                    s.context, object.name(), internal::CppAndPythonName("AddObject")));
  }
  for (int i = 0; i < 3; ++i) {
    RequireFinite(force[i], fmt::format("{}: force on body '{}'", s.context, body));
    RequireFinite(torque[i], fmt::format("{}: torque on body '{}'", s.context, body));
  }
  mjtNum* wrench = s.data.data->xfrc_applied + 6 * id;
  std::copy_n(force.data(), 3, wrench);
  std::copy_n(torque.data(), 3, wrench + 3);
}

std::vector<double> Scene::state() const {
  const State& s = open();
  std::vector<double> out(static_cast<size_t>(mj_stateSize(s.model(), kState)));
  mj_getState(s.model(), s.data.data, out.data(), kState);
  return out;
}

void Scene::SetState(std::span<const double> state) {
  State& s = open();
  const auto size = static_cast<size_t>(mj_stateSize(s.model(), kState));
  if (state.size() != size) {
    throw ArgumentError(fmt::format(
        "{}: a state has {} numbers, got {}; states fit only the model they were taken from",
        s.context, size, state.size()));
  }
  for (size_t i = 0; i < size; ++i) {
    if (std::isfinite(state[i])) continue;
    throw ArgumentError(
        fmt::format("{}: number {} of the state is {}: {}; all of a state is finite", s.context, i,
                    state[i], DescribeStateNumber(s.model(), i)));
  }
  s.FollowPool(state.data() + mj_stateSize(s.model(), mjSTATE_TIME));  // positions come next
  const auto set = [&] { mj_setState(s.model(), s.data.data, state.data(), kState); };
  // A state does not say which bodies sleep, and what it does not say must not matter.
  if (s.model()->opt.enableflags & mjENBL_SLEEP)
    internal::Guarded(s.context, s.data.data, [&] { WakeAll(s.model(), s.data.data); });
  internal::Guarded(s.context, s.data.data, set);
  ++s.states_set;
  Forward();
  internal::Guarded(s.context, s.data.data, set);  // the forward pass leaves its own warm start
}

}  // namespace robocell
