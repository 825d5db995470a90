#include "robocell/robot/robot_state.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
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

// One tick of a slot's controller.
void Run(GroupSlot& slot, Controller& controller) {
  controller.Compute(slot.ctrl);
  slot.drive->SetCtrl(slot.ctrl);
}

// Position targets at which the servos go on pushing as what they take over from.
void SeedServos(const GroupSlot& slot, Controller& controller) {
  const auto* servos = dynamic_cast<const ArmGroup*>(slot.drives.of(CtrlMode::kPosition));
  if (!servos || controller.mode() != CtrlMode::kPosition ||
      controller.port_kind() != TargetKind::kJointPositions)
    return;
  servos->JointPosForTorque(slot.group->joint_pos(), slot.group->joint_torque(),
                            controller.command_port());
}

// A message about a place without its "place: ", which the reader has in front of it already.
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
  if (refreshed_) RemakeChains();
  for (FtReading& reading : ft_sensors) reading.tare = {};
  ForControlled([](GroupSlot& slot) {
    Controller& controller = *slot.controller;
    controller.Reset();
    // The key that was restored holds servos only.
    if (controller.mode() != CtrlMode::kPosition) Run(slot, controller);
  });
}

void Robot::State::OnResetDone() {
  if (lost.empty()) ReadPorts();
}

// A robot made of an object's bodies is lost when that object is removed, until one with the same
// names is there again.
void Robot::State::OnRebuild() {
  lost.clear();
  try {
    FindBodies();
    FindFtSensors();
    RemakeChains();
    for (const auto& slot : slots) {
      if (slot->controller) SwitchTo(slot->controller->mode(), slot->drives, scene);
    }
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
  RemakeChains({scene.data()->qpos, static_cast<size_t>(scene.model()->nq)});
  refreshed_ = true;
}

void Robot::State::RemakeChains(std::span<const double> qpos) {
  ChainOptions options = chain_options;
  options.qpos = qpos;
  for (const auto& slot : slots) {
    if (slot->tip) slot->chain.emplace(scene.model(), record.root_body, *slot->tip, options);
  }
  refreshed_ = false;
}

void Robot::State::FindBodies() {
  const mjModel* m = scene.model();
  root_body = RequireId(m, mjOBJ_BODY, record.root_body, place());
  const int base = RequireId(m, mjOBJ_BODY, record.base_body, place());
  bodies.clear();
  geoms.clear();
  const std::vector<bool> inside = SubtreeMask(m, base);
  for (int b = base; b < m->nbody; ++b) {
    if (inside[b]) bodies.push_back(b);
  }
  for (int g = 0; g < m->ngeom; ++g) {
    if (inside[m->geom_bodyid[g]]) geoms.push_back(g);
  }
  FindCollisionGeoms();
}

// The pedestal is no part of the model that the configuration speaks of: it always counts.
void Robot::State::FindCollisionGeoms() {
  collision_geoms = geoms;
  if (record.config.collision_geoms.empty()) return;
  const mjModel* m = scene.model();
  std::set<int> chosen;
  for (const ElementRef& ref : record.config.collision_geoms)
    chosen.insert(FindElement(m, record, ref, {mjOBJ_GEOM}).id);
  if (record.pedestal_height > 0) chosen.insert(FindId(m, mjOBJ_GEOM, record.prefix + "pedestal"));
  std::erase_if(collision_geoms, [&](int g) { return !chosen.contains(g); });
}

// What they were tared by stays.
void Robot::State::FindFtSensors() {
  std::vector<FtReading> found;
  for (const ForceTorqueSensorSpec& spec : record.config.ft_sensors) {
    found.push_back({FtSensor(scene.model(), record, spec)});
    const auto known = std::find_if(ft_sensors.begin(), ft_sensors.end(), [&](const FtReading& r) {
      return r.sensor.name() == spec.name;
    });
    if (known != ft_sensors.end()) found.back().tare = known->tare;
  }
  ft_sensors = std::move(found);
}

std::vector<std::string> Robot::State::ft_sensor_names() const {
  std::vector<std::string> names;
  for (const FtReading& reading : ft_sensors) names.push_back(reading.sensor.name());
  return names;
}

FtReading& Robot::State::RequireFtSensor(const std::string& name) {
  RequireOpen();
  RequireBodies();
  for (FtReading& reading : ft_sensors) {
    if (reading.sensor.name() == name) return reading;
  }
  throw NotFoundError(NoSuchName(place(), "ft sensor", name, ft_sensor_names()) +
                      (ft_sensors.empty() ? " List them as `ft_sensors` of its configuration or of "
                                            "the ToolFrameSpec"
                                          : ""));
}

void Robot::State::AddGroup(MadeGroup made, const std::string& controller, bool must_be_driven) {
  if (reading_) {  // the ports it is writing to would be gone
    throw Error(place() + ": its groups cannot change while the arm's state is read; replace '" +
                made.group->name() +
                "' outside of the arm's joint_pos, joint_vel and joint_torque");
  }
  auto slot = std::make_shared<GroupSlot>();
  if (made.tip) slot->chain.emplace(scene.model(), record.root_body, *made.tip, chain_options);
  slot->tip = std::move(made.tip);
  slot->group = std::move(made.group);
  slot->drives =
      made.drives.groups == Drives{}.groups ? OwnDrive(slot->group) : std::move(made.drives);
  slot->arm = dynamic_cast<const ArmGroup*>(slot->group.get());
  for (const auto& drive : slot->drives.groups) {
    if (auto* arm = dynamic_cast<ArmGroup*>(drive.get())) arm->UseChain(&slot->chain);
  }
  if (slot->group->nu() == 0) {
    slot->why_no_controller =
        made.why_no_actuators.empty() ? "it has no actuators" : made.why_no_actuators;
    if (must_be_driven) {
      throw ArgumentError(
          fmt::format("{}: `control` asks for {}, but {}; remove it there, or give "
                      "the model position servos",
                      place(*slot), controller, slot->why_no_controller));
    }
  } else {
    try {
      Use(*slot, MakeController(controller,
                                RequireDrive(*slot, ControllerMode(controller, place(*slot)))));
    } catch (const ArgumentError& error) {
      if (must_be_driven) throw;
      slot->why_no_controller = WithoutPlace(error.what(), slot->group->place());
    }
  }
  const std::string& name = slot->group->name();
  const auto same = std::find_if(slots.begin(), slots.end(),
                                 [&](const auto& s) { return s->group->name() == name; });
  if (same == slots.end()) {
    slots.push_back(std::move(slot));
  } else {
    KeepIfRunning(std::exchange(*same, std::move(slot)));
  }
  ListKinds();
}

void Robot::State::ListKinds() {
  first_ = {};
  for (const auto& slot : slots) {
    GroupSlot*& first = first_[static_cast<size_t>(slot->group->kind())];
    if (!first) first = slot.get();
  }
  const GroupSlot* arm = FindKind(MoveGroupKind::kArm);
  pos.resize(arm ? arm->group->nq() : 0);
  vel.resize(arm ? arm->group->nv() : 0);
  trq.resize(arm ? arm->group->nv() : 0);
  ReadPorts();
}

GroupSlot* Robot::State::Find(const std::string& name) {
  for (const auto& slot : slots) {
    if (slot->group->name() == name) return slot.get();
  }
  return nullptr;
}

GroupSlot& Robot::State::Require(const std::string& name) {
  RequireBodies();
  if (GroupSlot* slot = Find(name)) return *slot;
  throw NotFoundError(NoSuchName(place(), "group", name, group_names()));
}

GroupSlot& Robot::State::RequireKind(MoveGroupKind kind) {
  RequireBodies();
  if (GroupSlot* slot = FindKind(kind)) return *slot;
  const std::string next =
      record.config.move_groups.empty()
          ? "Its configuration has none: declare one under `move_groups`, or use Robot::FromScene"
          : fmt::format("Declare one under `move_groups` with `kind: {}`", ToString(kind));
  throw NotFoundError(fmt::format("{}: has no {} group. Its groups: {}. {}", place(),
                                  ToString(kind), ListNames(group_names()), next));
}

Controller& Robot::State::RequireController(GroupSlot& slot) {
  if (slot.controller) return *slot.controller;
  throw NotFoundError(fmt::format("{} has no controller: {}", place(slot), slot.why_no_controller));
}

MoveGroup& Robot::State::RequireDrive(GroupSlot& slot, CtrlMode mode) {
  if (MoveGroup* drive = slot.drives.of(mode)) return *drive;
  // What its actuators are instead is said when they are asked for a position.
  if (mode == CtrlMode::kPosition) return *slot.group;
  throw ArgumentError(fmt::format("{} cannot be switched to {}: {}", place(slot), ToString(mode),
                                  slot.drives.why_none[static_cast<size_t>(mode)]));
}

void Robot::State::Use(GroupSlot& slot, std::shared_ptr<Controller> controller) {
  MoveGroup& drive = RequireDrive(slot, controller->mode());
  SwitchTo(controller->mode(), slot.drives, scene);
  const bool switched = slot.drive && slot.drive != &drive;
  if (switched) SeedServos(slot, *controller);
  KeepIfRunning(std::exchange(slot.controller, std::move(controller)));
  slot.drive = &drive;
  slot.ctrl.resize(drive.nu());
  // At once, so that nothing falls in a step before the next Update().
  if (switched) Run(slot, *slot.controller);
}

const Chain& Robot::State::RequireChain(GroupSlot& slot) {
  if (slot.chain) return *slot.chain;
  throw NotFoundError(place(slot) +
                      " has no chain: kinematics need a configured group of kind arm");
}

void Robot::State::ReadPorts() {
  RequireBodies();
  for (FtReading& reading : ft_sensors)
    reading.value = reading.sensor.Read(scene.model(), scene.data()) - reading.tare;
  const GroupSlot* arm = FindKind(MoveGroupKind::kArm);
  if (!arm || reading_) return;
  const Reading reading(reading_);
  arm->group->GetJointPos(pos);
  arm->group->GetJointVel(vel);
  arm->group->GetJointTorque(trq);
}

std::vector<std::string> Robot::State::group_names() const {
  std::vector<std::string> names;
  for (const auto& slot : slots) names.push_back(slot->group->name());
  return names;
}

void Robot::State::AppendGroups(std::vector<std::shared_ptr<MoveGroup>>& out) const {
  for (const auto& slot : slots) out.push_back(slot->group);
}

}  // namespace robocell
