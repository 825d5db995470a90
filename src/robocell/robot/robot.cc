// Robot: the functions of handles; make_robot.cc makes robots, apply.cc has Apply.
#include "robocell/robot/robot.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/kinematics/reach.h"
#include "robocell/mujoco/gravity.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/arm_ik.h"
#include "robocell/robot/measurement_cache.h"
#include "robocell/robot/robot_state.h"
#include "robocell/scene/hold_ctrl.h"

namespace robocell {
namespace {

// A gripper that is not a GripperGroup could not be used as one.
void RequireInterface(const MoveGroup* group) {
  if (!group) throw ArgumentError("a robot's group cannot be null");
  const std::string place = "group '" + group->name() + "'";
  if (group->kind() == MoveGroupKind::kGripper && !dynamic_cast<const GripperGroup*>(group)) {
    throw ArgumentError(place + ": a group of kind gripper derives from GripperGroup");
  }
  if (group->kind() == MoveGroupKind::kBase && !dynamic_cast<const BaseGroup*>(group)) {
    throw ArgumentError(place + ": a group of kind base derives from BaseGroup");
  }
}

std::vector<std::string> NamesOfKind(const Robot& robot, MoveGroupKind kind) {
  std::vector<std::string> names;
  for (const std::string& name : robot.group_names()) {
    if (robot.group(name).kind() == kind) names.push_back(name);
  }
  return names;
}

JointVector Positions(const MoveGroup& group) {
  JointVector q(group.nq());
  group.GetJointPos(std::span<double>(q.begin(), q.end()));
  return q;
}

// An arm that nothing drives still has actuators, which would pull it back.
void HoldWithoutController(Scene& scene, const MoveGroup& arm, const std::string& place) {
  scene.SyncPoses();
  const mjModel* m = scene.model();
  std::vector<bool> dofs(static_cast<size_t>(m->nv));
  std::vector<int> joints;
  for (const std::string& joint : arm.joint_names())
    joints.push_back(FindId(m, mjOBJ_JOINT, joint));
  for (const int joint : joints) dofs[m->jnt_dofadr[joint]] = true;
  for (const internal::JointFollower& f : internal::FollowersOf(m, joints))
    dofs[m->jnt_dofadr[f.joint]] = true;
  internal::HoldMoved(m, scene.data(), dofs, place);
}

}  // namespace

void Robot::RequireOpen() const { state_->RequireOpen(); }

Robot::State& Robot::open() const {
  RequireOpen();
  return *state_;
}

const std::string& Robot::name() const { return state_->record.name; }
const std::string& Robot::prefix() const { return state_->record.prefix; }
std::string Robot::OwnName(const std::string& name) const {
  return name.starts_with(prefix()) ? name.substr(prefix().size()) : name;
}
const RobotConfig& Robot::config() const { return open().record.config; }

std::vector<std::string> Robot::group_names() const { return open().group_names(); }
int Robot::group_count() const { return static_cast<int>(open().slots.size()); }
bool Robot::has_group(const std::string& name) const { return open().Find(name) != nullptr; }
MoveGroup& Robot::group(const std::string& name) const { return *open().Require(name).own->group; }
std::shared_ptr<MoveGroup> Robot::shared_group(const std::string& name) const {
  const std::shared_ptr<MoveGroup>& group = open().Require(name).own->group;
  return {std::make_shared<std::pair<Robot, std::shared_ptr<MoveGroup>>>(*this, group),
          group.get()};
}
MoveGroup& Robot::arm() const { return *open().RequireKind(MoveGroupKind::kArm).own->group; }
bool Robot::has_arm() const { return open().FindKind(MoveGroupKind::kArm) != nullptr; }
bool Robot::has_gripper() const { return open().FindKind(MoveGroupKind::kGripper) != nullptr; }

GripperGroup& Robot::gripper() const {
  return dynamic_cast<GripperGroup&>(*open().RequireKind(MoveGroupKind::kGripper).own->group);
}

std::string Robot::gripper_of(const std::string& arm) const {
  const internal::GroupSlot& slot = open().Require(arm);
  if (slot.own->group->kind() != MoveGroupKind::kArm) {
    throw ArgumentError(fmt::format("{} is of kind {}, and grippers go with arms: {}",
                                    open().place(slot), ToString(slot.own->group->kind()),
                                    ListNames(NamesOfKind(*this, MoveGroupKind::kArm))));
  }
  const internal::GroupSlot* gripper = open().GripperOf(slot);
  return gripper ? gripper->own->group->name() : "";
}

BaseGroup& Robot::base() const {
  return dynamic_cast<BaseGroup&>(*open().RequireKind(MoveGroupKind::kBase).own->group);
}

void Robot::SetGroup(std::shared_ptr<MoveGroup> group) {
  RequireInterface(group.get());
  internal::MadeGroup made{std::move(group)};
  const internal::GroupSlot* old = open().Find(made.group->name());
  const bool same_arm = old && old->own->tip && made.group->kind() == MoveGroupKind::kArm &&
                        old->own->group->joint_names() == made.group->joint_names();
  if (same_arm) made.tip = old->own->tip;
  open().AddGroup(std::move(made), "joint_position", false);
}

bool Robot::is_driven(const std::string& group) const {
  return open().Require(group).control->controller != nullptr;
}

Controller& Robot::controller(const std::string& group) const {
  return open().RequireController(open().Require(group));
}

std::shared_ptr<Controller> Robot::shared_controller(const std::string& group) const {
  struct Kept {  // ordered from the last to be destroyed to the first
    Robot robot;
    std::shared_ptr<internal::GroupSlot> slot;
    std::shared_ptr<internal::ControlledGroup> of;
    std::shared_ptr<Controller> controller;
  };
  controller(group);  // throws with the reason if there is none
  internal::GroupSlot& slot = open().Require(group);
  const auto kept = std::make_shared<Kept>(
      Kept{*this, slot.shared_from_this(), slot.control->of, slot.control->controller});
  return {kept, kept->controller.get()};
}

void Robot::SetController(const std::string& group, std::unique_ptr<Controller> controller) {
  if (!controller) throw ArgumentError(open().place() + ": a controller cannot be null");
  internal::GroupSlot& slot = open().Require(group);
  open().Use(slot, std::move(controller));
  slot.control->chosen = true;
}

void Robot::SetController(const std::string& group, const std::string& kind) {
  SetController(group, NewController(group, kind));
}

std::unique_ptr<Controller> Robot::NewController(const std::string& group,
                                                 const std::string& kind) const {
  internal::GroupSlot& slot = open().Require(group);
  const CtrlMode mode = ControllerMode(kind, open().place(slot));
  RequireControllable(*slot.own->group, kind, open().place(slot));
  return open().Successor(slot, kind, mode);
}

void Robot::ThrowOtherClass(const std::string& group, const Controller& made) const {
  throw ArgumentError(fmt::format(
      "{}: controller '{}' is of another class here than was asked for; put it in by its name, or "
      "give a class derived from it a kKind of its own and register that",
      open().place(open().Require(group)), made.kind()));
}

CtrlMode Robot::ctrl_mode() const {
  internal::GroupSlot& slot = open().RequireKind(MoveGroupKind::kArm);
  const CtrlMode declared = open().RequireController(slot).mode();
  return internal::ModeNow(slot.own->drives, open().scene).value_or(declared);
}

void Robot::set_ctrl_mode(CtrlMode mode) {
  if (!IsNamed(mode)) {
    throw ArgumentError(fmt::format("{}: there is no control mode {}; expected one of {}",
                                    open().place(), static_cast<int>(mode),
                                    ListNames(ValueNames<CtrlMode>())));
  }
  internal::GroupSlot& slot = open().RequireKind(MoveGroupKind::kArm);
  const bool there = slot.control->controller &&
                     slot.control->controller->kind() == internal::PortController(mode) &&
                     internal::ModeNow(slot.own->drives, open().scene).value_or(mode) == mode;
  if (!there) SetController(slot.own->group->name(), internal::PortController(mode));
  slot.control->chosen = true;
}

MoveGroup& Robot::drive(const std::string& group, CtrlMode mode) const {
  return open().RequireDrive(open().Require(group), mode);
}

std::vector<std::shared_ptr<MoveGroup>> Robot::groups_of_sole_handle() const {
  std::vector<std::shared_ptr<MoveGroup>> groups;
  if (state_.use_count() == 1) state_->AppendGroups(groups);  // not kept by the scene
  return groups;
}

std::vector<std::shared_ptr<MoveGroup>> GroupsKeptBy(const Scene& scene) {
  std::vector<std::shared_ptr<MoveGroup>> groups;
  for (const auto& kept : scene.kept_observers()) {
    const auto state = std::dynamic_pointer_cast<Robot::State>(kept);
    if (state) state->AppendGroups(groups);
  }
  return groups;
}

void Robot::Update() {
  State& state = open();
  state.ReadPorts();
  state.ForControlled([](internal::GroupControl& control) { control.Run(); });
}

StepResult Robot::StepN(int n) { return scene_.StepN(state_->paused ? 0 : n); }
bool Robot::paused() const { return open().paused; }
void Robot::set_paused(bool paused) { open().paused = paused; }

int Robot::n_joints() const { return arm().nq(); }
const std::vector<std::string>& Robot::joint_names() const { return arm().joint_names(); }
std::vector<Interval> Robot::joint_limits() const { return arm().joint_pos_limits(); }
std::span<const double> Robot::jnt_pos_msr() const { return open().pos; }
std::span<const double> Robot::jnt_vel_msr() const { return open().vel; }
std::span<const double> Robot::jnt_trq_msr() const { return open().trq; }

std::span<double> Robot::Port(TargetKind kind, const char* name, CtrlMode mode) const {
  internal::GroupSlot& slot = open().RequireKind(MoveGroupKind::kArm);
  Controller& controller = open().RequireController(slot);
  if (controller.port_kind() == kind) return controller.command_port();
  if (controller.mode() == mode) {
    throw Error(
        fmt::format("{}: there is no {} while its controller is '{}'; set ctrl_mode to {} "
                    "first",
                    open().place(slot), name, controller.kind(), ToString(mode)));
  }
  if (!slot.own->drives.of(mode)) {
    throw ArgumentError(fmt::format("{} has no {}: {}", open().place(slot), name,
                                    slot.own->drives.why_none[static_cast<size_t>(mode)]));
  }
  return slot.control->ports.of(kind);
}

void Robot::WritePort(TargetKind kind, std::span<double> port, std::span<const double> values) {
  internal::GroupSlot& slot = open().RequireKind(MoveGroupKind::kArm);
  RequireValues([&] { return open().place(slot); }, "joint", values, static_cast<int>(port.size()),
                joint_names());
  std::copy(values.begin(), values.end(), port.begin());
  slot.control->ports.SetCommanded(kind);
}

std::span<double> Robot::jnt_pos_cmd() const {
  return Port(TargetKind::kJointPositions, "jnt_pos_cmd", CtrlMode::kPosition);
}

std::span<double> Robot::jnt_vel_cmd() const {
  return Port(TargetKind::kJointVelocities, "jnt_vel_cmd", CtrlMode::kVelocity);
}

std::span<double> Robot::jnt_trq_cmd() const {
  return Port(TargetKind::kJointTorques, "jnt_trq_cmd", CtrlMode::kTorque);
}

void Robot::SetJntPosCmd(std::span<const double> q) {
  WritePort(TargetKind::kJointPositions, jnt_pos_cmd(), q);
}
void Robot::SetJntVelCmd(std::span<const double> velocity) {
  WritePort(TargetKind::kJointVelocities, jnt_vel_cmd(), velocity);
}
void Robot::SetJntTrqCmd(std::span<const double> torque) {
  WritePort(TargetKind::kJointTorques, jnt_trq_cmd(), torque);
}

void Robot::SetJointPos(std::span<const double> q, bool call_forward) {
  internal::GroupSlot& slot = open().RequireKind(MoveGroupKind::kArm);
  auto* arm = dynamic_cast<ArmGroup*>(slot.own->group.get());
  if (arm) {
    arm->WriteJointPos(q);
    open().WarnBeyondLimits(*arm, q);
  } else {
    slot.own->group->SetJointPos(q);
  }
  if (slot.control->controller) {
    slot.control->PlaceAt(scene_.time());
  } else {
    HoldWithoutController(scene_, *slot.own->group, open().place(slot));
  }
  if (call_forward) scene_.Forward();
  open().ReadPorts();
}

const Chain& Robot::chain() const {
  State& state = open();
  return state.RequireChain(state.RequireKind(MoveGroupKind::kArm));
}

const Chain& Robot::chain(const std::string& group) const {
  return open().RequireChain(open().Require(group));
}

Pose Robot::FkFrame() const { return chain().Fk(Positions(arm())); }
Pose Robot::FkFrame(std::span<const double> q) const { return chain().Fk(q); }

IkResult Robot::Ik(const Pose& tcp_in_robot_base, IkOptions options) const {
  const Chain& arm_chain = chain();
  if (options.seed.empty()) options.seed = Positions(arm());
  return robocell::Ik(arm_chain, tcp_in_robot_base, ForArm(*this, std::move(options)));
}

LockedJoints Robot::LockGroups(std::span<const std::string> groups) const {
  if (groups.empty()) return {};  // called before the inverse kinematics of each pose
  std::vector<std::string> in_chain;
  const std::vector<std::string>& of_chain = chain().joint_names();
  for (const std::string& name : groups) {
    for (const std::string& joint : group(name).joint_names()) {
      if (std::find(of_chain.begin(), of_chain.end(), joint) != of_chain.end())
        in_chain.push_back(joint);
    }
  }
  return LockJoints(chain(), in_chain);
}

Pose Robot::base_in_world() const {
  const State& state = open();
  state.RequireBodies();
  state.scene.SyncPoses();
  const mjData* d = state.scene.data();
  const int id = state.root_body;
  return Pose::FromWxyz(d->xpos + 3 * id, d->xquat + 4 * id);
}

Pose Robot::tcp_in_world() const { return arm().leaf_frame_to_world(); }

const std::string& Robot::tcp_site() const {
  static const std::string kNone;
  const ChainTip& tip = chain().tip();
  return tip.kind == ChainTip::Kind::kSite ? tip.name : kNone;
}

Pose Robot::tip_to_tcp() const {
  const Chain& to_tcp = chain();
  const std::string& body = open().tip_body.empty() ? to_tcp.joints().back().body : open().tip_body;
  const Chain to_tip(open().scene.model(), open().record.root_body, ChainTip::Body(body));
  const JointVector q(to_tcp.n_joints());
  return to_tip.Fk({q.data(), static_cast<size_t>(to_tip.n_joints())}).inverse() * to_tcp.Fk(q);
}

Eigen::Vector3d Robot::gravity_in_base(std::optional<double> gravity_z) const {
  if (gravity_z && !std::isfinite(*gravity_z))
    throw ArgumentError(
        fmt::format("{}: gravity_z is {}; it must be finite", open().place(), *gravity_z));
  if (gravity_z) return base_in_world().rotation().transpose() * Eigen::Vector3d(0, 0, *gravity_z);
  if (const ArmGroup* arm = open().RequireKind(MoveGroupKind::kArm).own->arm)
    return arm->gravity_in_base();
  const Eigen::Map<const Eigen::Vector3d> gravity(internal::EffectiveGravity(open().scene.model()));
  return base_in_world().rotation().transpose() * gravity;
}

void Robot::GravityTorques(std::span<double> out, std::optional<double> gravity_z) const {
  internal::GroupSlot& slot = open().RequireKind(MoveGroupKind::kArm);
  const Chain& arm_chain = open().RequireChain(slot);
  const bool of_scene = slot.own->arm && !gravity_z;
  arm_chain.GravityTorques(Positions(*slot.own->group),
                           of_scene ? slot.own->arm->gravity_in_base() : gravity_in_base(gravity_z),
                           out);
}

void Robot::RefreshToolInertia() { open().RefreshChains(); }

std::vector<std::string> Robot::ft_sensor_names() const { return state_->ft_sensor_names(); }

Wrench Robot::ft_sensor(const std::string& name) const {
  return state_->RequireFtSensor(name).value;
}

Pose Robot::ft_sensor_frame(const std::string& name) const {
  const internal::FtSensor& sensor = state_->RequireFtSensor(name).sensor;
  state_->scene.SyncPoses();
  return sensor.frame_in_world(state_->scene.data());
}

void Robot::TareFtSensor(const std::string& name) {
  internal::FtReading& reading = state_->RequireFtSensor(name);
  reading.tare = reading.sensor.Read(state_->scene.model(), state_->scene.data());
  reading.value = {};
}

double Robot::reach() const {
  std::optional<double>& reach = open().reach;
  if (!reach) reach = config().reach;
  if (!reach) {
    const std::string what = "reach from " + chain().base_body() + " to " + chain().tip().name;
    reach = internal::CachedMeasurement(
        scene_.compiled(), what, [&] { return std::vector<double>{ApproximateReach(chain())}; })[0];
  }
  return *reach;
}

const std::vector<int>& Robot::body_ids() const { return open().bodies; }
const std::vector<int>& Robot::geom_ids() const { return open().geoms; }
const std::vector<int>& Robot::collision_geom_ids() const { return open().collision_geoms; }

}  // namespace robocell
