#include "robocell/env/env_state.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env_impl.h"
#include "robocell/env/number_list.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/joint_pos_for_ctrl.h"
#include "robocell/robot/planar_motion.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/task/task_calls.h"

namespace robocell {
namespace {

// Sets the target of a group with position servos to the one that gives the present controls. Other
// groups keep theirs.
void RecallTarget(Robot& robot, const std::string& name) {
  Controller& controller = robot.controller(name);
  if (controller.target_kind() != TargetKind::kJointPositions ||
      controller.mode() != CtrlMode::kPosition)
    return;
  const MoveGroup& group = robot.group(name);
  if (const auto* base = dynamic_cast<const BaseGroup*>(&group)) {
    // The joint values of a base on wheels are not those of the wheels.
    const internal::PlanarMotion* motion = internal::PlanarMotion::Of(*base);
    if (motion && !motion->drives_sideways()) return;
  }
  const mjModel* m = robot.scene().model();
  const mjData* d = robot.scene().data();
  const std::vector<std::string>& joints = group.joint_names();
  std::vector<double> target(controller.target().begin(), controller.target().end());
  for (const std::string& actuator : group.actuator_names()) {
    const int id = FindId(m, mjOBJ_ACTUATOR, actuator);
    if (id < 0 || !internal::IsPositionServo(m, id)) return;
    const std::string joint = internal::ActsOnJoint(m, id)
                                  ? ElementName(m, mjOBJ_JOINT, m->actuator_trnid[2 * id])
                                  : std::string();
    const auto at = std::ranges::find(joints, joint) - joints.begin();
    if (at >= std::ssize(target)) {  // on a tendon, or a joint that follows one of the arm
      if (group.kind() == MoveGroupKind::kArm && internal::JointPosForCtrl(group, target))
        controller.SetTarget(target);
      return;
    }
    const mjtNum ctrl = d->ctrl[m->actuator_ctrladr[id]];
    const mjtNum* bias = m->actuator_biasprm + mjNBIAS * id;
    const mjtNum gain = m->actuator_gainprm[mjNGAIN * id], gear = internal::Gear(m, id);
    // Plain servos keep the number itself, to the bit.
    const bool is_plain = gain == -bias[1] && bias[0] == 0 && gear == 1;
    target[at] = is_plain ? ctrl : internal::RestingLength(m, id, {.ctrl = ctrl}) / gear;
  }
  controller.SetTarget(target);
}

constexpr size_t kNumbersBeforePhysics = 8;  // the rig's pose, ticks

constexpr double kMostTicks = 1e15;
constexpr double kMostBodies = 1e9;

// A number of steps, or of bodies.
int64_t ToWhole(double number, double most) {
  if (number >= 0 && number <= most && number == std::floor(number))
    return static_cast<int64_t>(number);
  throw ArgumentError(fmt::format(
      "these numbers are not a state of an environment: {} where a whole number is expected",
      number));
}

// The hash function FNV-1a of Fowler, Noll and Vo.
class NamesHash {
 public:
  void Add(std::string_view name) {
    for (const char c : name) AddByte(static_cast<unsigned char>(c));
    AddByte(0);  // "ab", "c" are not "a", "bc"
  }
  // Returns a value that a double represents exactly.
  double value() const { return static_cast<double>(hash_ >> 16); }

 private:
  void AddByte(unsigned char byte) { hash_ = (hash_ ^ byte) * 0x100000001b3u; }
  uint64_t hash_ = 0xcbf29ce484222325u;
};

// Hashes the names that give the numbers of a state their meaning; other fixed bodies do not
// matter.
double HashOfNames(const EnvConfig& config, const mjModel* m) {
  NamesHash hash;
  const auto add = [&](mjtObj type, int id) {
    const char* name = mj_id2name(m, type, id);
    hash.Add(name ? name : "");
  };
  for (const std::string& robot : config.robots.keys()) hash.Add(robot);
  for (int j = 0; j < m->njnt; ++j) {
    add(mjOBJ_JOINT, j);
    add(mjOBJ_BODY, m->jnt_bodyid[j]);
    hash.Add(fmt::to_string(m->jnt_type[j]));
  }
  for (int b = 0; b < m->nbody; ++b) {
    if (m->body_mocapid[b] >= 0) add(mjOBJ_BODY, b);
  }
  for (int a = 0; a < m->nactuator; ++a) add(mjOBJ_ACTUATOR, a);
  return hash.value();
}

// The free joints and mocap bodies in the subtree of a body.
struct Movables {
  std::vector<int> joints, mocaps;
};

Movables MovablesOf(const mjModel* m, int root) {
  Movables out;
  for (int j = 0; j < m->njnt; ++j) {
    if (m->jnt_type[j] == mjJNT_FREE && internal::IsInSubtree(m, m->jnt_bodyid[j], root))
      out.joints.push_back(j);
  }
  for (int b = 0; b < m->nbody; ++b) {
    if (m->body_mocapid[b] >= 0 && internal::IsInSubtree(m, b, root))
      out.mocaps.push_back(m->body_mocapid[b]);
  }
  return out;
}

void MovePose(const Pose& by, double* pos, double* quat) {
  (by * Pose::FromWxyz(pos, quat)).ToWxyz(pos, quat);
}

// Linear velocities and accelerations of free joints have the world's axes, angular ones the
// body's.
void TurnLinear(const Pose& by, double* v) {
  const Eigen::Vector3d turned = by.rotation() * Eigen::Vector3d(v[0], v[1], v[2]);
  std::copy_n(turned.data(), 3, v);
}

void Move(const Pose& by, const Movables& movables, const mjModel* m, mjData* d) {
  for (const int j : movables.joints) {
    double* qpos = d->qpos + m->jnt_qposadr[j];
    MovePose(by, qpos, qpos + 3);
    TurnLinear(by, d->qvel + m->jnt_dofadr[j]);
    TurnLinear(by, d->qacc_warmstart + m->jnt_dofadr[j]);
  }
  for (const int i : movables.mocaps) MovePose(by, d->mocap_pos + 3 * i, d->mocap_quat + 4 * i);
}

}  // namespace

std::vector<double> EnvState::numbers() const {
  std::vector<double> out(7);
  internal::PutTquat(root_frame_to_world, out);
  out.push_back(static_cast<double>(ticks));
  internal::PutList(physics, out);
  internal::PutList(task, out);
  internal::PutList(variations, out);
  std::vector<double> pairs;
  for (const auto& [a, b] : touching)
    pairs.insert(pairs.end(), {static_cast<double>(a), static_cast<double>(b)});
  internal::PutList(pairs, out);
  out.push_back(static_cast<double>(arms.size()));
  for (const ArmMemory& arm : arms) internal::PutMemory(arm, out);
  out.push_back(names_hash);
  return out;
}

EnvState EnvState::FromNumbers(std::span<const double> numbers) {
  internal::NumberReader reader(numbers, "state of an environment");
  EnvState state;
  const std::span<const double> p = reader.Take(7);
  state.root_frame_to_world = Pose({p[0], p[1], p[2]}, Quaternion{p[3], p[4], p[5], p[6]});
  state.ticks = ToWhole(reader.Take(1)[0], kMostTicks);
  state.physics = reader.List();
  state.task = reader.List();
  state.variations = reader.List();
  const std::vector<double> pairs = reader.List();
  for (size_t i = 0; i + 1 < pairs.size(); i += 2)
    state.touching.emplace_back(static_cast<int>(ToWhole(pairs[i], kMostBodies)),
                                static_cast<int>(ToWhole(pairs[i + 1], kMostBodies)));
  const size_t arms = reader.Count();
  for (size_t i = 0; i < arms; ++i) state.arms.push_back(internal::ReadArmMemory(reader));
  state.names_hash = reader.Take(1)[0];
  reader.RequireEnd();
  return state;
}

EnvState Env::State::state() const {
  EnvState state = CellState();
  if (task_) state.task = internal::TaskCalls(*task_).Memory();
  return state;
}

// Returns the numbers from which the model of this episode follows.
std::vector<double> Env::State::DrawnVariations() const {
  std::vector<double> drawn = variations_.drawn();
  if (config_.randomize) drawn.push_back(randomization_seed_);
  return drawn;
}

EnvState Env::State::CellState() const {
  RequireReady();
  EnvState state{.root_frame_to_world = config_.root_frame_to_world,
                 .physics = scene_.state(),
                 .variations = DrawnVariations(),
                 .touching = collisions_.memory(),
                 .ticks = ticks_,
                 .names_hash = HashOfNames(config_, scene_.model())};
  for (const internal::ArmDriver& arm : arms_) state.arms.push_back(arm.memory());
  return state;
}

void Env::State::RequireState(const EnvState& state) const {
  bool fits = state.names_hash == HashOfNames(config_, scene_.model()) &&
              state.arms.size() == arms_.size() &&
              state.variations.size() == DrawnVariations().size() &&
              (task_ ? internal::TaskCalls(*task_).CanRecall(state.task) : state.task.empty()) &&
              state.physics.size() == scene_.state().size();
  for (size_t i = 0; fits && i < arms_.size(); ++i) {
    const ArmMemory own = arms_[i].memory();
    fits = state.arms[i].commanded.size() == own.commanded.size() &&
           state.arms[i].fingers.window.size() == own.fingers.window.size();
  }
  if (!fits) {
    throw ArgumentError(place() +
                        ": the state is of another environment; states fit those of the same "
                        "configuration, but for root_frame_to_world");
  }
  if (task_) {
    const std::string why = internal::TaskCalls(*task_).WhyNotRecalled(state.task);
    if (!why.empty()) {
      throw ArgumentError(fmt::format("{}: the memory of task '{}' in the state: {}", place(),
                                      config_.task->kind(), why));
    }
  }
  if (config_.randomize) {
    const double seed = state.variations.back();
    if (!(seed >= 0 && seed < kRandomizationSeeds) || seed != std::floor(seed)) {
      throw ArgumentError(
          fmt::format("{}: the seed of `randomize` in the state is {}; in a state it is a whole "
                      "number, 0 to {:.10g}",
                      place(), seed, kRandomizationSeeds - 1));
    }
  }
  // A task's memory may have any other content.
  const auto task =
      static_cast<std::ptrdiff_t>(kNumbersBeforePhysics + 1 + state.physics.size() + 1);
  const std::vector<double> numbers = state.numbers();
  for (std::ptrdiff_t i = 0; i < std::ssize(numbers); ++i) {
    const bool is_sound = std::abs(numbers[i]) <= mjMAXVAL || i + 1 == std::ssize(numbers);
    if (is_sound || (i >= task && i < task + std::ssize(state.task))) continue;
    throw ArgumentError(
        fmt::format("{}: number {} of the state is {}; in a state numbers are finite and at most "
                    "{:g}, what the engine accepts",
                    place(), i, numbers[i], mjMAXVAL));
  }
}

// A task's memory of its own attributes may hold places in the world.
void Env::State::RequireFrame(const EnvState& state, StateFrame frame) const {
  const bool is_moved =
      !internal::IsSamePlace(config_.root_frame_to_world, state.root_frame_to_world);
  if (frame != StateFrame::kRoot || !is_moved || !task_ ||
      internal::TaskCalls(*task_).HoldsElsewhere(state.task))
    return;
  throw ArgumentError(
      fmt::format("{}: the state is of a rig that stands elsewhere, and task '{}' has no memory() "
                  "of its own: its attributes may hold places in the world. Define memory() and "
                  "recall() with places in the root frame",
                  place(), config_.task->kind()));
}

// Restores everything but the task and the observation.
void Env::State::RecallCell(const EnvState& state) {
  if (config_.randomize) {
    if (state.variations.back() != randomization_seed_) Randomize(state.variations.back());
  } else if (state.variations != variations_.drawn()) {
    variations_.Apply(state.variations);
  }
  scene_.SetState(state.physics);
  RecallOthers();
  for (size_t i = 0; i < arms_.size(); ++i) arms_[i].Recall(state.arms[i]);
  collisions_.Recall(state.touching);
  ticks_ = state.ticks;
}

// Gives groups beside the arms and grippers of the actions, such as a rail, the targets that their
// controls in the restored state come from.
void Env::State::RecallOthers() {
  for (Robot& robot : RobotsOf(scene_.inner())) {
    for (const std::string& group : robot.group_names()) {
      if (!robot.is_driven(group) || robot.group(group).kind() == MoveGroupKind::kGripper) continue;
      const bool is_of_actions = std::ranges::any_of(arms_, [&](const internal::ArmDriver& arm) {
        return arm.robot().name() == robot.name() && arm.robot().arm().name() == group;
      });
      if (!is_of_actions) RecallTarget(robot, group);
    }
  }
}

void Env::State::MoveToRoot(const Pose& from) {
  const Pose by = config_.root_frame_to_world * from.inverse();
  const mjModel* m = scene_.model();
  for (const std::string& id : config_.root_frame_objects.keys()) {
    const int root = RequireId(m, mjOBJ_BODY, scene_.compiled()->object(id).root_body, place());
    Move(by, MovablesOf(m, root), m, scene_.data());
  }
  scene_.SetState(scene_.state());  // and the quantities derived from it
}

void Env::State::SetState(const EnvState& state, StateFrame frame) {
  const SceneUse::Claim claim(scene_.use(), "Env.set_state");
  RequireState(state);
  RequireFrame(state, frame);
  const bool never_begun = phase_ == Phase::kUnready;
  phase_ = Phase::kBroken;  // until the state is complete
  RecallCell(state);
  if (frame == StateFrame::kRoot) MoveToRoot(state.root_frame_to_world);
  if (task_) {
    // What Begin sets is not all in a task's memory, and this task may never have begun.
    if (state.ticks == 0 || never_begun) {
      cell_.Begin();
    } else {
      cell_.ForgetSubtasks();
    }
    internal::TaskCalls(*task_).Recall(state.task);
  }
  pacer_.Start(TimeSinceReset());
  cameras_.GoOnFrom(TimeSinceReset());
  Observe();
  phase_ = Phase::kReady;
  for (EnvObserver* observer : observers_) observer->OnStart();
}

void Env::State::Save(const std::string& name) {
  if (name.empty()) throw ArgumentError(place() + ": a saved state needs a name");
  saved_[name] = {.generation = scene_.generation(), .state = state()};
}

Env::State::Snapshot& Env::State::RequireSnapshot(const std::string& name) {
  const auto found = saved_.find(name);
  if (found == saved_.end()) throw NotFoundError(NoSuchName(place(), "saved state", name, saved()));
  return found->second;
}

void Env::State::Restore(const std::string& name) {
  const SceneUse::Claim claim(scene_.use(), "Env.restore");
  const Snapshot& snapshot = RequireSnapshot(name);
  if (snapshot.generation != scene_.generation()) {
    throw Error(
        fmt::format("{}: the scene was compiled again since '{}' was saved, so that there "
                    "is no way back to it",
                    place(), name));
  }
  SetState(snapshot.state, StateFrame::kWorld);
}

void Env::State::Forget(const std::string& name) {
  RequireSnapshot(name);
  saved_.erase(name);
}

std::vector<std::string> Env::State::saved() const {
  std::vector<std::string> names;
  for (const auto& [name, snapshot] : saved_) names.push_back(name);
  return names;
}

}  // namespace robocell
