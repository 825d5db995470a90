#include "robocell/robot/robot_state.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <exception>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/element_lookup.h"

namespace robocell {
namespace {

// True for a scope.
class Reading {
 public:
  explicit Reading(bool& flag) : flag_(flag) { flag_ = true; }
  ~Reading() { flag_ = false; }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

 private:
  bool& flag_;
};

// Makes the controller continue from the one that it replaces. Returns the targets at which
// position servos apply the same force as before; empty for other modes, and for groups other than
// arms.
std::vector<double> TakeOver(const internal::ControlledGroup& group, Controller& controller) {
  const auto* drive = dynamic_cast<const ArmGroup*>(group.drives.of(controller.mode()));
  const MoveGroup& arm = *group.group;
  if (!drive || controller.mode() == CtrlMode::kTorque) return {};
  if (controller.mode() == CtrlMode::kVelocity) {
    controller.ResetTo(arm.joint_vel());
    return {};
  }
  std::vector<double> servos(static_cast<size_t>(drive->nq()));
  drive->JointPosForTorque(arm.joint_pos(), arm.joint_vel(), arm.joint_torque(), servos);
  controller.ResetTo(servos);
  return servos;
}

// Adopts the forces at the present place. After a teleport without a step they may still be those
// of the old place.
void BringForces(Scene scene, const internal::GroupControl& control) {
  if (control.may_have_forces_of_before(scene.time())) scene.Forward();
}

// Names the actuators that the model of an arm may have for a mode.
std::string ActuatorsFor(CtrlMode mode) {
  const std::string servos = std::string(internal::ActuatorWord(CtrlMode::kPosition)) + "s";
  return mode == CtrlMode::kPosition
             ? servos
             : fmt::format("{}s or {}", internal::ActuatorWord(mode), servos);
}

// Returns a message about a place without its "place: ", which already precedes it.
std::string WithoutPlace(const std::string& text, const std::string& place) {
  return text.starts_with(place + ": ") ? text.substr(place.size() + 2) : text;
}

}  // namespace

Robot::State::State(const Scene& s, RobotRecord r, ChainOptions options)
    : scene(s.inner()), record(std::move(r)), chain_options(std::move(options)) {
  FindBodies();
  FindFtSensors();
}

void Robot::State::ThrowClosed() const {
  throw ClosedError("robot '" + record.name + "' is closed: its scene was closed");
}

void Robot::State::OnReset() {
  if (!lost.empty()) return;
  ForChains([this](internal::ControlledGroup& group) {
    if (group.refreshed() || group.is_stale(scene.model())) group.RemakeChain(scene.model());
  });
  for (internal::FtReading& reading : ft_sensors) reading.tare = {};
  for (const auto& slot : slots) {
    if (slot->own->gripper) slot->own->gripper->SetClosingPose("");
  }
  std::exception_ptr failed;
  ForControlled([&](internal::GroupControl& control) {
    try {
      control.Reset();
      // The restored key only holds servos.
      if (control.controller->mode() != CtrlMode::kPosition) control.Run();
    } catch (...) {  // reset the other groups anyway
      if (!failed) failed = std::current_exception();
    }
  });
  if (failed) std::rethrow_exception(failed);
}

void Robot::State::OnResetDone() {
  if (lost.empty()) ReadPorts();
}

void Robot::State::ReadChainAgain(internal::ControlledGroup& group) const {
  group.RemakeChain(scene.model(), group.refreshed() ? positions() : std::span<const double>());
}

void Robot::State::OnForward() {
  if (!lost.empty()) return;
  ForChains([this](internal::ControlledGroup& group) {
    if (group.is_stale(scene.model())) ReadChainAgain(group);
  });
}

void Robot::State::OnBodyPut(int body, const Pose& pose_in_world) {
  if (!lost.empty() || body != FindId(scene.model(), mjOBJ_BODY, record.base_body)) return;
  const mjData* d = scene.data();
  const Pose from = Pose::FromWxyz(d->xpos + 3 * static_cast<ptrdiff_t>(body),
                                   d->xquat + 4 * static_cast<ptrdiff_t>(body));
  const internal::GroupSlot* base = FindKind(MoveGroupKind::kBase);
  leaving_.Warn(scene, record.name, base ? place(*base) : place(), record.base.kind, from,
                pose_in_world);
}

// A robot made of an object's bodies is lost when that object is removed, until one with the same
// names exists again.
void Robot::State::OnRebuild() {
  lost.clear();
  try {
    FindBodies();
    FindFtSensors();
    ForChains([this](internal::ControlledGroup& group) { ReadChainAgain(group); });
    ReadPorts();
  } catch (const NotFoundError& error) {
    lost = error.what();
    bodies.clear();
    geoms.clear();
    collision_geoms.clear();
  }
}

void Robot::State::ThrowLost() const {
  throw ClosedError("robot '" + record.name +
                    "' went with an object that was removed from its scene; add the object again, "
                    "or make another robot: " +
                    lost);
}

void Robot::State::RefreshChains() {
  ForChains(
      [this](internal::ControlledGroup& group) { group.RemakeChain(scene.model(), positions()); });
}

template <class Visit>
void Robot::State::ForChains(Visit&& visit) {
  for (const auto& slot : slots) {
    visit(*slot->own);
    internal::GroupControl& control = *slot->control;
    if (!control.controller || control.of == slot->own) continue;
    try {
      visit(*control.of);
    } catch (const NotFoundError&) {  // its robot was removed, or lost its tool
      PutInstead(*slot, internal::PortController(control.controller->mode()));
    }
  }
}

std::span<const double> Robot::State::positions() const {
  return {scene.data()->qpos, static_cast<size_t>(scene.model()->nq)};
}

void Robot::State::FindBodies() {
  const mjModel* m = scene.model();
  root_body = RequireId(m, mjOBJ_BODY, record.root_body, place());
  const int base = RequireId(m, mjOBJ_BODY, record.base_body, place());
  bodies.clear();
  geoms.clear();
  const std::vector<bool> inside = internal::SubtreeMask(m, base);
  for (int b = base; b < m->nbody; ++b) {
    if (inside[b]) bodies.push_back(b);
  }
  for (int g = 0; g < m->ngeom; ++g) {
    if (inside[m->geom_bodyid[g]]) geoms.push_back(g);
  }
  FindCollisionGeoms();
}

// The pedestal does not belong to the configuration's model: it always counts.
void Robot::State::FindCollisionGeoms() {
  collision_geoms = geoms;
  if (record.config.collision_geoms.empty()) return;
  const mjModel* m = scene.model();
  std::set<int> chosen;
  for (const ElementRef& ref : record.config.collision_geoms)
    chosen.insert(internal::FindElement(m, record, ref, {mjOBJ_GEOM}).id);
  if (record.pedestal_height > 0) chosen.insert(FindId(m, mjOBJ_GEOM, record.prefix + "pedestal"));
  std::erase_if(collision_geoms, [&](int g) { return !chosen.contains(g); });
}

// Tares are kept.
void Robot::State::FindFtSensors() {
  std::vector<internal::FtReading> found;
  for (const ForceTorqueSensorSpec& spec : record.config.ft_sensors) {
    found.push_back({internal::FtSensor(scene.model(), record, spec)});
    const auto known =
        std::find_if(ft_sensors.begin(), ft_sensors.end(),
                     [&](const internal::FtReading& r) { return r.sensor.name() == spec.name; });
    if (known != ft_sensors.end()) found.back().tare = known->tare;
  }
  ft_sensors = std::move(found);
}

std::vector<std::string> Robot::State::ft_sensor_names() const {
  std::vector<std::string> names;
  for (const internal::FtReading& reading : ft_sensors) names.push_back(reading.sensor.name());
  return names;
}

internal::FtReading& Robot::State::RequireFtSensor(const std::string& name) {
  RequireOpen();
  RequireBodies();
  for (internal::FtReading& reading : ft_sensors) {
    if (reading.sensor.name() == name) return reading;
  }
  throw NotFoundError(NoSuchName(place(), "ft sensor", name, ft_sensor_names()) +
                      (ft_sensors.empty() ? " List them as `ft_sensors` of its configuration or of "
                                            "the ToolFrameSpec"
                                          : ""));
}

void Robot::State::AddGroup(internal::MadeGroup made, const std::string& controller,
                            bool must_be_driven) {
  if (reading_) {  // the ports it is writing to would be destroyed
    throw Error(place() + ": its groups cannot change while the arm's state is read; replace '" +
                made.group->name() +
                "' outside of the arm's joint_pos, joint_vel and joint_torque");
  }
  const std::string own_controller = made.own_controller;
  const std::string why_no_actuators =
      made.why_no_actuators.empty() ? "it has no actuators" : made.why_no_actuators;
  auto slot = std::make_shared<internal::GroupSlot>();
  slot->own = std::make_shared<internal::ControlledGroup>(scene, std::move(made), record.root_body,
                                                          chain_options);
  slot->control = std::make_shared<internal::GroupControl>();
  if (!own_controller.empty()) {
    if (must_be_driven) {
      throw ArgumentError(
          fmt::format("{}: `control` is {}, but this group only has the controller '{}'; "
                      "leave it out of `control`",
                      place(*slot), controller, own_controller));
    }
    Drive(*slot, own_controller, true);
  } else if (slot->own->group->nu() == 0) {
    slot->control->why_no_controller = why_no_actuators;
    if (must_be_driven) {
      throw ArgumentError(fmt::format(
          "{}: `control` is {}, but {}; remove it there, or give the model {}", place(*slot),
          controller, why_no_actuators, ActuatorsFor(ControllerMode(controller, place(*slot)))));
    }
  } else {
    try {
      Drive(*slot, controller, must_be_driven);
    } catch (const ArgumentError& error) {
      if (must_be_driven) throw;
      const std::string& why = slot->own->drives.why_not(ControllerMode(controller, place(*slot)));
      slot->control->why_no_controller =
          why.empty() ? WithoutPlace(error.what(), slot->own->group->place()) : why;
    }
  }
  const std::string& name = slot->own->group->name();
  const auto same = std::find_if(slots.begin(), slots.end(),
                                 [&](const auto& s) { return s->own->group->name() == name; });
  if (same == slots.end()) {
    slots.push_back(std::move(slot));
  } else {
    KeepIfRunning(std::exchange(*same, std::move(slot)));
  }
  ListKinds();
}

void Robot::State::ShareControls(State& other) {
  for (const auto& slot : slots) {
    if (const internal::GroupSlot* known = other.Find(slot->own->group->name()))
      slot->control = known->control;
  }
  ListKinds();
}

void Robot::State::Drive(internal::GroupSlot& slot, const std::string& controller,
                         bool configured) {
  const CtrlMode wanted = ControllerMode(controller, place(slot));
  if (configured) RequireDrive(slot, wanted);  // throws if it cannot, whatever drives it now
  const std::string& key = slot.own->control_key();
  if (const auto known = FindControl(key)) {
    slot.control = known;
    const bool by_default = !known->chosen && known->controller->kind() != controller;
    if (configured && by_default && known->controller->mode() == wanted)
      PutInstead(slot, controller);
    return;
  }
  const CtrlMode mode = internal::ModeNow(slot.own->drives, scene).value_or(wanted);
  const std::string kind = mode == wanted ? controller : internal::PortController(mode);
  if (slot.own->group->kind() == MoveGroupKind::kArm) {
    slot.control->ports.Resize(slot.own->group->nq(), slot.own->group->nv());
    slot.control->ports.Reseed(*slot.own->group);
  }
  RequireUndriven(slot);
  Use(slot, MakeController(kind, RequireDrive(slot, mode)));
}

std::shared_ptr<internal::GroupControl> Robot::State::FindControl(const std::string& key) const {
  return std::dynamic_pointer_cast<internal::GroupControl>(scene.FindObserver(key));
}

void Robot::State::RequireUndriven(const internal::GroupSlot& slot) const {
  if (slot.own->control_key().empty()) return;
  for (const auto& known : scene.FindObservers(internal::kControlKey)) {
    const auto* other = dynamic_cast<const internal::GroupControl*>(known.get());
    if (!other || !other->controller || other == slot.control.get()) continue;
    const std::vector<std::string>& theirs = other->of->group->actuator_names();
    std::vector<std::string> shared = slot.own->group->actuator_names();
    std::erase_if(shared, [&](const std::string& name) {
      return std::find(theirs.begin(), theirs.end(), name) == theirs.end();
    });
    if (shared.empty()) continue;
    throw ArgumentError(fmt::format(
        "{}: {} {} driven by {} already, an arm of other joints ({}), and an actuator is driven by "
        "one arm alone. Command that one, or make a robot of the same joints, which shares what "
        "drives them",
        slot.own->group->place(), ListNames(shared), shared.size() == 1 ? "is" : "are",
        other->of->group->place(), ListNames(other->of->group->joint_names())));
  }
}

std::unique_ptr<Controller> Robot::State::Successor(internal::GroupSlot& slot,
                                                    const std::string& kind, CtrlMode mode) {
  std::unique_ptr<Controller> controller = MakeController(kind, RequireDrive(slot, mode));
  BringForces(scene, *slot.control);
  if (slot.control->controller) TakeOver(*slot.own, *controller);
  return controller;
}

void Robot::State::PutInstead(internal::GroupSlot& slot, const std::string& controller) {
  Controller& known = *slot.control->controller;
  const std::span<const double> port = known.command_port();
  const std::vector<double> command(port.begin(), port.end());
  const TargetKind kind = known.port_kind();
  Use(slot, Successor(slot, controller, known.mode()));
  Controller& put = *slot.control->controller;
  if (put.port_kind() == kind)
    std::copy(command.begin(), command.end(), put.command_port().begin());
}

std::vector<internal::GroupSlot*> Robot::State::OfKind(MoveGroupKind kind) const {
  std::vector<internal::GroupSlot*> found;
  for (const auto& slot : slots) {
    if (slot->own->group->kind() == kind) found.push_back(slot.get());
  }
  return found;
}

int Robot::State::LastLink(const internal::GroupSlot& arm) const {
  const mjModel* m = scene.model();
  int last = -1;
  for (const std::string& name : arm.own->group->joint_names()) {
    const int joint = FindId(m, mjOBJ_JOINT, name);
    if (joint < 0) continue;
    const int body = m->jnt_bodyid[joint];
    if (last < 0 || internal::IsInSubtree(m, body, last)) last = body;
  }
  return last;
}

bool Robot::State::Carries(const internal::GroupSlot& arm,
                           const internal::GroupSlot& gripper) const {
  const int last = LastLink(arm);
  if (last < 0) return false;
  const mjModel* m = scene.model();
  const std::vector<std::string>& joints = gripper.own->group->joint_names();
  const bool moves = std::any_of(joints.begin(), joints.end(), [&](const std::string& name) {
    const int joint = FindId(m, mjOBJ_JOINT, name);
    return joint >= 0 && internal::IsInSubtree(m, m->jnt_bodyid[joint], last);
  });
  if (moves || !joints.empty()) return moves;
  // A suction cup has no joints.
  const std::vector<std::string>& actuators = gripper.own->group->actuator_names();
  return std::any_of(actuators.begin(), actuators.end(), [&](const std::string& name) {
    const int actuator = FindId(m, mjOBJ_ACTUATOR, name);
    const int body = actuator < 0 ? -1 : internal::BodyOfActuator(m, actuator);
    return body >= 0 && internal::IsInSubtree(m, body, last);
  });
}

internal::GroupSlot* Robot::State::CarrierOf(const internal::GroupSlot& gripper) const {
  const std::vector<internal::GroupSlot*> arms = OfKind(MoveGroupKind::kArm);
  const auto found = std::find_if(arms.begin(), arms.end(), [&](const internal::GroupSlot* arm) {
    return Carries(*arm, gripper);
  });
  return found == arms.end() ? nullptr : *found;
}

internal::GroupSlot* Robot::State::GripperOf(const internal::GroupSlot& arm) const {
  const std::vector<internal::GroupSlot*> grippers = OfKind(MoveGroupKind::kGripper);
  // There is no choice, whatever it hangs on, and a user's own groups are not called.
  if (grippers.size() == 1 && OfKind(MoveGroupKind::kArm).size() == 1) return grippers[0];
  for (internal::GroupSlot* gripper : grippers) {
    if (Carries(arm, *gripper)) return gripper;
  }
  for (internal::GroupSlot* gripper : grippers) {
    if (!CarrierOf(*gripper)) return gripper;
  }
  return nullptr;
}

void Robot::State::ListKinds() {
  first_ = {};
  controls_.clear();
  for (const auto& slot : slots) {
    controls_.push_back(slot->control.get());
    internal::GroupSlot*& first = first_[static_cast<size_t>(slot->own->group->kind())];
    if (!first) first = slot.get();
  }
  const internal::GroupSlot* arm = FindKind(MoveGroupKind::kArm);
  if (arm) first_[static_cast<size_t>(MoveGroupKind::kGripper)] = GripperOf(*arm);
  arm_ = arm ? arm->own->group.get() : nullptr;
  pos.resize(arm_ ? arm_->nq() : 0);
  vel.resize(arm_ ? arm_->nv() : 0);
  trq.resize(arm_ ? arm_->nv() : 0);
  ReadPorts();
}

void Robot::State::WarnBeyondLimits(const ArmGroup& arm, std::span<const double> q) {
  if (warned_beyond_limits) return;
  const size_t i = arm.FindBeyondLimits(q);
  if (i >= q.size()) return;
  warned_beyond_limits = true;
  const Interval limits = arm.joint_pos_limits()[i];
  LogWarn(
      fmt::format("{}: joint '{}' is set to {:g}, outside its limits {:g} to {:g}, which "
                  "push it back (reported once)",
                  arm.place(), arm.joint_names()[i], q[i], limits.lower, limits.upper));
}

internal::GroupSlot* Robot::State::Find(const std::string& name) {
  for (const auto& slot : slots) {
    if (slot->own->group->name() == name) return slot.get();
  }
  return nullptr;
}

internal::GroupSlot& Robot::State::Require(const std::string& name) {
  RequireBodies();
  if (internal::GroupSlot* slot = Find(name)) return *slot;
  throw NotFoundError(NoSuchName(place(), "group", name, group_names()));
}

internal::GroupSlot& Robot::State::RequireKind(MoveGroupKind kind) {
  RequireBodies();
  if (internal::GroupSlot* slot = FindKind(kind)) return *slot;
  if (const auto grippers = OfKind(kind); !grippers.empty()) {
    throw NotFoundError(fmt::format(
        "{}: arm '{}', the first of its `move_groups`, carries no gripper: '{}' is on arm '{}'. "
        "Declare the arm with the gripper first, or take group '{}' by its name",
        place(), FindKind(MoveGroupKind::kArm)->own->group->name(), grippers[0]->own->group->name(),
        CarrierOf(*grippers[0])->own->group->name(), grippers[0]->own->group->name()));
  }
  const std::string next =
      is_of_chain()
          ? "It was made of a chain by " + internal::CppAndPythonName("Robot::FromScene") +
                ", which makes an arm only: give the RobotSpec a `config` with this group, or "
                "drive its actuators by their names with " +
                internal::CppAndPythonName("Scene::SetActuatorCtrl")
      : record.config.move_groups.empty()
          ? "Its configuration has none: declare one under `move_groups`, or use " +
                internal::CppAndPythonName("Robot::FromScene")
          : fmt::format("Declare one under `move_groups` with `kind: {}`", ToString(kind));
  throw NotFoundError(fmt::format("{}: has no {} group. Its groups: {}. {}", place(),
                                  ToString(kind), ListNames(group_names()), next));
}

Controller& Robot::State::RequireController(internal::GroupSlot& slot) {
  if (slot.control->controller) return *slot.control->controller;
  throw NotFoundError(
      fmt::format("{} has no controller: {}", place(slot), slot.control->why_no_controller));
}

MoveGroup& Robot::State::RequireDrive(internal::GroupSlot& slot, CtrlMode mode) {
  if (MoveGroup* drive = slot.own->drives.of(mode)) return *drive;
  throw ArgumentError(fmt::format("{} cannot be {}: {}", place(slot),
                                  mode == CtrlMode::kPosition
                                      ? "driven to positions"
                                      : std::string("switched to ") + ToString(mode),
                                  slot.own->drives.why_not(mode)));
}

void Robot::State::Use(internal::GroupSlot& slot, std::shared_ptr<Controller> controller) {
  const std::string& key = slot.own->control_key();
  if (!slot.control->controller) {
    if (const auto known = FindControl(key)) {
      slot.control = known;
    } else {
      RequireUndriven(slot);
    }
  }
  internal::GroupControl& control = *slot.control;
  MoveGroup& drive = RequireDrive(slot, controller->mode());
  const internal::GroupControl::Driven before = control.now();
  const internal::ModeSwitches switches(scene);
  try {
    const bool other_mode = control.controller && control.controller->mode() != controller->mode();
    BringForces(scene, control);
    const bool switched =
        internal::SwitchTo(controller->mode(), slot.own->drives, scene) || other_mode;
    std::vector<double> servos;
    if (switched) servos = TakeOver(*slot.own, *controller);
    control.Put(std::move(controller), slot.own, drive);
    // Runs at once, so that nothing falls in a step before the next Update().
    if (switched) control.Guarded([](internal::GroupControl& c) { c.Run(); });
    if (!servos.empty()) control.SettleLags(servos);
  } catch (...) {
    control.PutBack(before);
    switches.PutBack(scene);
    throw;
  }
  if (!key.empty() && !FindControl(key)) scene.AddObserver(slot.control, key);
}

const Chain& Robot::State::RequireChain(internal::GroupSlot& slot) {
  if (slot.own->chain) return *slot.own->chain;
  throw NotFoundError(place(slot) +
                      " has no chain: kinematics need a configured group of kind arm");
}

void Robot::State::ReadPorts() {
  RequireBodies();
  for (internal::FtReading& reading : ft_sensors)
    reading.value = reading.sensor.Read(scene.model(), scene.data()) - reading.tare;
  if (!arm_ || reading_) return;
  const Reading reading(reading_);
  arm_->GetJointPos(pos);
  arm_->GetJointVel(vel);
  arm_->GetJointTorque(trq);
}

std::vector<std::string> Robot::State::group_names() const {
  std::vector<std::string> names;
  for (const auto& slot : slots) names.push_back(slot->own->group->name());
  return names;
}

void Robot::State::AppendGroups(std::vector<std::shared_ptr<MoveGroup>>& out) const {
  for (const auto& slot : slots) out.push_back(slot->own->group);
}

}  // namespace robocell
