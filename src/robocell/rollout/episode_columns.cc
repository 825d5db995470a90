#include "robocell/rollout/episode_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/mujoco/names.h"
#include "robocell/rollout/ctrl_units.h"

namespace robocell {
namespace {

const std::vector<std::string> kPoseNames = {"x", "y", "z", "qx", "qy", "qz", "qw"};
const std::vector<std::string> kTwistNames = {"vx", "vy", "vz", "wx", "wy", "wz"};

ColumnId AddPose(EpisodeSchema& schema, const std::string& name, const std::string& frame,
                 const std::string& text) {
  return schema.AddColumn({.name = name,
                           .shape = {7},
                           .units = "m, 1",
                           .frame = frame,
                           .names = kPoseNames,
                           .description = text});
}

const char* JointUnit(const mjModel* m, int joint, bool rate) {
  switch (m->jnt_type[joint]) {
    case mjJNT_SLIDE:
      return rate ? "m/s" : "m";
    case mjJNT_FREE:
      return rate ? "m/s, rad/s" : "m, 1";
    case mjJNT_BALL:
      return rate ? "rad/s" : "1";
    default:
      return rate ? "rad/s" : "rad";
  }
}

// "rad" when all are the same, else all in their order.
std::string OneOrAll(const std::vector<std::string>& units) {
  const bool same =
      std::adjacent_find(units.begin(), units.end(), std::not_equal_to<>()) == units.end();
  if (same && !units.empty()) return units.front();
  return fmt::format("{}", fmt::join(units, ", "));
}

// Units of a group's joints: "rad", "m", or all in their order. "" when one of them is no joint of
// the model: a group of the user's own kind may have other coordinates.
std::string JointUnits(const mjModel* m, const std::vector<std::string>& joints, bool rate) {
  std::vector<std::string> units;
  for (const std::string& joint : joints) {
    const int id = FindId(m, mjOBJ_JOINT, joint);
    if (id < 0) return "";
    units.push_back(JointUnit(m, id, rate));
  }
  return OneOrAll(units);
}

// Experts without names of phases are in phase 0 throughout.
void CheckPhase(int phase, const std::vector<std::string>& names) {
  if (phase >= 0 && phase < std::max(1, static_cast<int>(names.size()))) return;
  const std::string allowed =
      names.empty() ? "phase_names() is empty, so it must be 0"
                    : fmt::format("it must be 0 to {}, an index into phase_names(): {}",
                                  names.size() - 1, ListNames(names));
  throw ArgumentError(fmt::format("the expert's phase() is {}; {}", phase, allowed));
}

}  // namespace

std::array<double, 7> PoseRow(const Pose& pose) {
  const Eigen::Vector3d& p = pose.translation();
  const Quaternion& q = pose.quaternion();
  return {p.x(), p.y(), p.z(), q[0], q[1], q[2], q[3]};
}

RobotColumns::RobotColumns(EpisodeSchema& schema, Robot robot) : robot_(std::move(robot)) {
  const std::string path = "robots/" + robot_.name() + "/", base = "base of " + robot_.name();
  for (const std::string& name : robot_.group_names()) AddGroup(schema, name);
  base_pose_ =
      AddPose(schema, path + "base_pose", "world", "Pose of the robot base frame (its root body).");
  if (has_arm_) {
    tcp_pose_ = AddPose(schema, path + "tcp_pose", "world", "Pose of the TCP.");
    tcp_in_base_ = AddPose(schema, path + "tcp_pose_in_base", base, "Pose of the TCP.");
    action_pose_ = AddPose(schema, path + "action/tcp_pose", base,
                           "Where the commanded arm joints put the TCP.");
    action_twist_ = schema.AddColumn(
        {.name = path + "action/tcp_twist",
         .shape = {6},
         .units = "m, rad",
         .frame = base,
         .names = kTwistNames,
         .description = "From the present TCP pose to the commanded one: difference of "
                        "position, then rotation vector."});
  }
  if (has_gripper_) {
    opening_ =
        schema.AddColumn({.name = path + "opening",
                          .units = "1",
                          .description = "Measured opening of the gripper: 0 closed, 1 open."});
  }
}

void RobotColumns::AddGroup(EpisodeSchema& schema, const std::string& name) {
  MoveGroup& group = robot_.group(name);
  const std::string path = "robots/" + robot_.name() + "/", own = path + name + "/";
  const mjModel* m = robot_.scene().model();
  GroupColumns columns{.name = name,
                       .group = robot_.shared_group(name),
                       .kind = group.kind(),
                       .q = std::vector<double>(group.nq()),
                       .v = std::vector<double>(group.nv())};
  has_arm_ |= group.kind() == MoveGroupKind::kArm;
  has_gripper_ |= group.kind() == MoveGroupKind::kGripper;
  const std::vector<std::string>& joints = group.joint_names();
  const std::vector<std::string> q_names =
      group.nq() == static_cast<int>(joints.size()) ? joints : std::vector<std::string>{};
  const std::vector<std::string> v_names =
      group.nv() == static_cast<int>(joints.size()) ? joints : std::vector<std::string>{};
  const std::string units = JointUnits(m, joints, false);
  if (group.nq() > 0) {
    columns.qpos = schema.AddColumn(
        {.name = own + "qpos", .shape = {group.nq()}, .units = units, .names = q_names});
    columns.qvel = schema.AddColumn({.name = own + "qvel",
                                     .shape = {group.nv()},
                                     .units = JointUnits(m, joints, true),
                                     .names = v_names});
  }
  // What nothing drives is not acted on; arms and grippers that nothing drives are refused.
  const bool may_be_undriven = group.kind() == MoveGroupKind::kGeneric && !robot_.is_driven(name);
  if (group.nu() > 0 && !may_be_undriven) {
    const Controller& port = robot_.controller(name);
    const bool gripper = group.kind() == MoveGroupKind::kGripper;
    const int64_t n = static_cast<int64_t>(port.commanded_joint_pos().size());
    const std::vector<std::string> names = gripper ? std::vector<std::string>{"opening"} : q_names;
    const std::string unit = gripper ? "1" : units;
    columns.target =
        schema.AddColumn({.name = own + "target",
                          .shape = {n},
                          .units = unit,
                          .names = names,
                          .description = "Target of the group's controller before the action."});
    columns.action = schema.AddColumn({.name = path + "action/" + name,
                                       .shape = {n},
                                       .units = unit,
                                       .names = names,
                                       .description = "Absolute target that the action set."});
    columns.action_rel =
        schema.AddColumn({.name = path + "action/" + name + "_relative",
                          .shape = {n},
                          .units = unit,
                          .names = names,
                          .description = "The same minus the target before the action."});
    columns.before.resize(n);
  }
  groups_.push_back(std::move(columns));
}

void RobotColumns::RequireSameGroups() const {
  const auto refuse = [&](const std::string& name, const char* what) {
    throw Error(
        fmt::format("robot '{}' / group '{}' was {} during the episode, whose columns were "
                    "laid out at its start; change groups before, in the sampler or in the "
                    "begin() of the expert",
                    robot_.name(), name, what));
  };
  for (const GroupColumns& columns : groups_) {
    if (&robot_.group(columns.name) != columns.group.get()) refuse(columns.name, "replaced");
  }
  const std::vector<std::string> names = robot_.group_names();
  if (names.size() > groups_.size()) refuse(names.back(), "added");
}

void RobotColumns::PutState(EpisodeWriter& writer) {
  RequireSameGroups();
  for (GroupColumns& columns : groups_) {
    MoveGroup& group = robot_.group(columns.name);
    if (group.nq() > 0) {
      group.GetJointPos(columns.q);
      group.GetJointVel(columns.v);
      writer.Put(columns.qpos, std::span<const double>(columns.q));
      writer.Put(columns.qvel, std::span<const double>(columns.v));
    }
    if (!columns.before.empty()) {
      const std::span<const double> target = robot_.controller(columns.name).commanded_joint_pos();
      std::copy(target.begin(), target.end(), columns.before.begin());
      writer.Put(columns.target, target);
    }
  }
  writer.Put(base_pose_, std::span<const double>(PoseRow(robot_.base_in_world())));
  if (has_arm_) {
    tcp_before_ = robot_.arm().leaf_frame_to_robot();
    writer.Put(tcp_pose_, std::span<const double>(PoseRow(robot_.tcp_in_world())));
    writer.Put(tcp_in_base_, std::span<const double>(PoseRow(tcp_before_)));
  }
  if (has_gripper_) writer.Put(opening_, robot_.gripper().opening());
}

void RobotColumns::PutAction(EpisodeWriter& writer) {
  RequireSameGroups();
  for (const GroupColumns& columns : groups_) {
    if (columns.before.empty()) continue;
    const Controller& port = robot_.controller(columns.name);
    std::vector<double> relative(port.commanded_joint_pos().begin(),
                                 port.commanded_joint_pos().end());
    for (size_t i = 0; i < relative.size(); ++i) relative[i] -= columns.before[i];
    writer.Put(columns.action, port.commanded_joint_pos());
    writer.Put(columns.action_rel, std::span<const double>(relative));
    if (columns.kind == MoveGroupKind::kArm && columns.name == robot_.arm().name())
      PutArmAction(writer, port);
  }
}

void RobotColumns::PutArmAction(EpisodeWriter& writer, const Controller& port) {
  const Pose commanded = robot_.FkFrame(port.commanded_joint_pos());
  const Eigen::Matrix<double, 6, 1> twist = PoseDifference(tcp_before_, commanded);
  writer.Put(action_pose_, std::span<const double>(PoseRow(commanded)));
  writer.Put(action_twist_, std::span<const double>(twist.data(), 6));
}

SceneColumns::SceneColumns(EpisodeSchema& schema, Scene scene, std::vector<std::string> objects,
                           std::vector<std::string> phases)
    : scene_(std::move(scene)),
      objects_(std::move(objects)),
      phases_(phases),
      warnings_before_(ReadWarnings(scene_.data())) {
  time_ = schema.AddColumn({.name = "time", .units = "s"});
  phase_ =
      schema.AddColumn({.name = "phase", .type = ColumnType::kInt32, .values = std::move(phases)});
  for (const std::string& object : objects_) {
    object_poses_.push_back(
        AddPose(schema, "objects/" + object + "/pose", "world", "Pose of the object's root body."));
  }
  reward_ = schema.AddColumn(
      {.name = "reward", .units = "1", .description = "Of the state that the action led to."});
  success_ = schema.AddColumn({.name = "success",
                               .type = ColumnType::kBool,
                               .description = "Whether the action led to success."});
  terminated_ = schema.AddColumn({.name = "terminated",
                                  .type = ColumnType::kBool,
                                  .description = "The episode ended with this action."});
  truncated_ = schema.AddColumn({.name = "truncated",
                                 .type = ColumnType::kBool,
                                 .description = "The episode was cut off after this action."});
  ik_failed_ = schema.AddColumn({.name = "ik_failed",
                                 .type = ColumnType::kBool,
                                 .description = "A pose command of the action had no solution: its "
                                                "group kept its target."});
  warnings_ = schema.AddColumn({.name = "engine_warnings",
                                .type = ColumnType::kInt32,
                                .description = "Engine warnings since the start of the episode."});
  control_ = schema.AddTable("control");
  const mjModel* m = scene_.model();
  control_time_ = schema.AddColumn({.name = "time", .units = "s"}, control_);
  if (m->nu > 0) {
    std::vector<std::string> names;
    for (int a = 0; a < m->nactuator; ++a) {
      for (int k = 0; k < m->actuator_ctrlnum[a]; ++k)
        names.push_back(ElementName(m, mjOBJ_ACTUATOR, a));
    }
    control_ctrl_ = schema.AddColumn(
        {.name = "ctrl",
         .shape = {m->nu},
         .units = OneOrAll(CtrlUnits(m)),
         .names = std::move(names),
         .description = "Raw controls that act from this time on; replaying them from the "
                        "first row's state gives the episode."},
        control_);
  }
}

void SceneColumns::PutState(EpisodeWriter& writer, int phase) {
  writer.Put(time_, scene_.time());
  CheckPhase(phase, phases_);
  writer.Put(phase_, static_cast<int32_t>(phase));
  for (size_t i = 0; i < objects_.size(); ++i) {
    const std::string& body = scene_.compiled()->object(objects_[i]).root_body;
    writer.Put(object_poses_[i], std::span<const double>(PoseRow(scene_.body_pose(body))));
  }
}

void SceneColumns::PutOutcome(EpisodeWriter& writer, const RowOutcome& outcome) {
  if (!std::isfinite(outcome.reward)) {
    throw ArgumentError(
        fmt::format("the task's reward() is {} at t = {:.3f} s; rewards must be "
                    "finite numbers",
                    outcome.reward, scene_.time()));
  }
  writer.Put(reward_, outcome.reward);
  writer.Put(success_, outcome.success);
  writer.Put(terminated_, outcome.terminated);
  writer.Put(truncated_, outcome.truncated);
  writer.Put(ik_failed_, outcome.ik_failed);
  writer.Put(warnings_, static_cast<int32_t>(warnings().total()));
}

void SceneColumns::PutControl(EpisodeWriter& writer, const mjModel* model, const mjData* data) {
  writer.Put(control_time_, static_cast<double>(data->time));
  if (model->nu > 0)
    writer.Put(control_ctrl_, std::span<const double>(data->ctrl, static_cast<size_t>(model->nu)));
  writer.EndRow(control_);
}

}  // namespace robocell
