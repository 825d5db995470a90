#include "robocell/features/robot_features.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/planar_motion.h"

namespace robocell {
namespace {

const char* UnitOfJoint(const mjModel* m, int joint, bool rate) {
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

// Returns true for a base whose joint values are its place on the floor, not those of its wheels.
bool IsOnWheels(const MoveGroup& group) {
  const auto* base = dynamic_cast<const BaseGroup*>(&group);
  const internal::PlanarMotion* motion = base ? internal::PlanarMotion::Of(*base) : nullptr;
  return motion && !motion->drives_sideways();
}

std::string UnitsOf(const Robot& robot, const MoveGroup& group, bool rate) {
  if (IsOnWheels(group)) return rate ? "m/s, m/s, rad/s" : "m, m, rad";
  return UnitsOfJoints(robot.scene().model(), group.joint_names(), rate);
}

// Returns the names of joints that have one position each; empty otherwise.
std::vector<std::string> NamesOf(const Robot& robot, const MoveGroup& group, int count) {
  if (IsOnWheels(group)) return {"x", "y", "yaw"};
  const bool has_one_each = count == static_cast<int>(group.joint_names().size());
  return has_one_each ? OwnNames(robot, group.joint_names()) : std::vector<std::string>{};
}

std::string PathOf(const Robot& robot) { return "robots/" + robot.name() + "/"; }
std::string SourceOf(const Robot& robot) { return "robot " + robot.name(); }
std::string BaseOf(const Robot& robot) { return "base of " + robot.name(); }

// A group without actuators has no commands; arms and grippers without them are rejected.
bool IsCommanded(const Robot& robot, const MoveGroup& group) {
  const bool may_be_undriven =
      group.kind() == MoveGroupKind::kGeneric && !robot.is_driven(group.name());
  return group.nu() > 0 && !may_be_undriven;
}

// Gives a feature the ranges of joints; those that do not fit it are left out.
void SetRange(Feature& feature, const std::vector<Interval>& limits) {
  if (static_cast<int64_t>(limits.size()) != feature.size()) return;
  for (const Interval& limit : limits) {
    feature.lower.push_back(limit.lower);
    feature.upper.push_back(limit.upper);
  }
}

// Returns the feature of what is measured: limits and targets give way a little under load.
Feature Measured(Feature feature) {
  constexpr double kSlack = 0.1;  // of the range
  for (size_t i = 0; i < feature.lower.size(); ++i) {
    const double slack = kSlack * (feature.upper[i] - feature.lower[i]);
    if (!std::isfinite(slack)) continue;
    feature.lower[i] -= slack;
    feature.upper[i] += slack;
  }
  return feature;
}

// Describes a target of the group's controller, or its change.
Feature TargetFeature(const Robot& robot, MoveGroup& group, const std::string& name,
                      FeatureRole role, const std::string& description) {
  const bool gripper = group.kind() == MoveGroupKind::kGripper;
  const auto size =
      static_cast<int64_t>(robot.controller(group.name()).commanded_joint_pos().size());
  Feature feature{.column = {.name = name,
                             .shape = {size},
                             .units = gripper ? "1" : UnitsOf(robot, group, false),
                             .names = gripper ? std::vector<std::string>{"opening"}
                                              : NamesOf(robot, group, group.nq()),
                             .description = description},
                  .role = role,
                  .source = SourceOf(robot)};
  if (gripper) {
    feature.lower.assign(static_cast<size_t>(size), 0);
    feature.upper.assign(static_cast<size_t>(size), 1);
  } else if (group.kind() == MoveGroupKind::kArm) {
    SetRange(feature, group.joint_pos_limits());
  }
  return feature;
}

Quaternion UnitQuaternionOf(std::string_view action, const Quaternion& q) {
  try {
    return UnitQuaternion(q);
  } catch (const ArgumentError& error) {
    throw ArgumentError(fmt::format("action '{}': {}", action, error.what()));
  }
}

}  // namespace

std::string UnitsOfJoints(const mjModel* m, const std::vector<std::string>& joints, bool rate) {
  std::vector<std::string> units;
  for (const std::string& joint : joints) {
    const int id = FindId(m, mjOBJ_JOINT, joint);
    if (id < 0) return "";
    units.emplace_back(UnitOfJoint(m, id, rate));
  }
  const bool same = std::ranges::adjacent_find(units, std::not_equal_to<>()) == units.end();
  if (same && !units.empty()) return units.front();
  return fmt::format("{}", fmt::join(units, ", "));
}

std::vector<std::string> OwnNames(const Robot& robot, const std::vector<std::string>& elements) {
  std::vector<std::string> names;
  for (const std::string& element : elements) names.push_back(robot.OwnName(element));
  return names;
}

RobotFeatures::RobotFeatures(Robot robot) : FeatureSource(robot.scene()), robot_(std::move(robot)) {
  const std::string path = PathOf(robot_), source = SourceOf(robot_);
  for (const std::string& name : robot_.group_names()) AddGroup(name);
  const auto add_pose = [&](const std::string& name, const std::string& frame,
                            const std::string& text) {
    Add(PoseFeature(path + name, frame, FeatureRole::kObservation, source, text));
  };
  add_pose("base_pose", "world", "Pose of the robot base frame (its root body).");
  if (has_arm_) {
    add_pose("tcp_pose", "world", "Pose of the TCP.");
    add_pose("tcp_pose_in_base", BaseOf(robot_), "Pose of the TCP.");
  }
  if (has_gripper_) {
    Add(Measured({.column = {.name = path + "opening",
                             .units = "1",
                             .description = "Measured opening of the gripper: 0 closed, 1 open."},
                  .lower = {0},
                  .upper = {1},
                  .source = source}));
  }
}

void RobotFeatures::AddGroup(const std::string& name) {
  MoveGroup& group = robot_.group(name);
  const std::string own = PathOf(robot_) + name + "/";
  has_arm_ |= group.kind() == MoveGroupKind::kArm;
  has_gripper_ |= group.kind() == MoveGroupKind::kGripper;
  Group entry{name, robot_.shared_group(name), group.nq(), group.nv(), 0};
  if (group.nq() > 0) {
    Feature qpos{.column = {.name = own + "qpos",
                            .shape = {group.nq()},
                            .units = UnitsOf(robot_, group, false),
                            .names = NamesOf(robot_, group, group.nq())},
                 .source = SourceOf(robot_)};
    SetRange(qpos, group.joint_pos_limits());
    Add(Measured(std::move(qpos)));
    Add({.column = {.name = own + "qvel",
                    .shape = {group.nv()},
                    .units = UnitsOf(robot_, group, true),
                    .names = NamesOf(robot_, group, group.nv())},
         .source = SourceOf(robot_)});
  }
  if (IsCommanded(robot_, group)) {
    Add(Measured(TargetFeature(robot_, group, own + "target", FeatureRole::kObservation,
                               "Target of the group's controller before the action.")));
    entry.targets = static_cast<int>(features().back().size());
  }
  groups_.push_back(std::move(entry));
}

void RobotFeatures::RequireSameGroups() const {
  const auto refuse = [&](const std::string& name, const char* what) {
    throw Error(
        fmt::format("robot '{}' / group '{}' was {} during the episode, whose columns were "
                    "laid out at its start; change groups before, in the sampler or in the "
                    "begin() of the expert",
                    robot_.name(), name, what));
  };
  for (const Group& entry : groups_) {
    if (&robot_.group(entry.name) != entry.group.get()) refuse(entry.name, "replaced");
  }
  if (robot_.group_count() > static_cast<int>(groups_.size()))
    refuse(robot_.group_names().back(), "added");
}

void RobotFeatures::ReadNumbers(std::span<double> out) {
  RequireSameGroups();
  const auto next = [&](int size) {
    const std::span<double> part = out.first(static_cast<size_t>(size));
    out = out.subspan(static_cast<size_t>(size));
    return part;
  };
  for (const Group& entry : groups_) {
    if (entry.nq > 0) {
      entry.group->GetJointPos(next(entry.nq));
      entry.group->GetJointVel(next(entry.nv));
    }
    if (entry.targets > 0) {
      const std::span<const double> target = robot_.controller(entry.name).commanded_joint_pos();
      std::ranges::copy(target, next(entry.targets).begin());
    }
  }
  PutPose(robot_.base_in_world(), next(kPoseNumbers));
  if (has_arm_) {
    PutPose(robot_.tcp_in_world(), next(kPoseNumbers));
    PutPose(robot_.arm().leaf_frame_to_robot(), next(kPoseNumbers));
  }
  if (has_gripper_) next(1)[0] = robot_.gripper().opening();
}

RobotActions::RobotActions(Robot robot) : robot_(std::move(robot)), name_(robot_.name()) {
  const std::string path = PathOf(robot_) + "action/";
  for (const std::string& name : robot_.group_names()) {
    MoveGroup& group = robot_.group(name);
    if (!IsCommanded(robot_, group)) continue;
    const bool gripper = group.kind() == MoveGroupKind::kGripper;
    Add(TargetFeature(robot_, group, path + name, FeatureRole::kAction,
                      "Absolute target that the action set."),
        {name, Kind::kTarget, gripper});
    Feature relative = TargetFeature(robot_, group, path + name + "_relative", FeatureRole::kAction,
                                     "The same minus the target before the action.");
    for (size_t i = 0; i < relative.lower.size(); ++i) {
      const double most = relative.upper[i] - relative.lower[i];
      relative.lower[i] = -most;
      relative.upper[i] = most;
    }
    Add(std::move(relative), {name, Kind::kRelative, gripper});
    if (group.kind() != MoveGroupKind::kArm || name != robot_.arm().name()) continue;
    Add(PoseFeature(path + "tcp_pose", BaseOf(robot_), FeatureRole::kAction, SourceOf(robot_),
                    "Where the commanded arm joints put the TCP."),
        {name, Kind::kPose, false});
    Add({.column = {.name = path + "tcp_displacement",
                    .shape = {6},
                    .units = "m, rad",
                    .frame = BaseOf(robot_),
                    .names = {"x", "y", "z", "rx", "ry", "rz"},
                    .description = "From the present TCP pose to the commanded one: difference of "
                                   "position, then rotation vector."},
         .role = FeatureRole::kAction,
         .source = SourceOf(robot_)},
        {name, Kind::kDisplacement, false});
  }
}

void RobotActions::Add(Feature feature, Part part) {
  const bool relative = part.kind == Kind::kRelative;
  before_.emplace_back(relative ? static_cast<size_t>(feature.size()) : 0);
  features_.push_back(std::move(feature));
  parts_.push_back(std::move(part));
}

void RobotActions::Begin() {
  for (size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].kind == Kind::kRelative)
      std::ranges::copy(robot_.controller(parts_[i].group).commanded_joint_pos(),
                        before_[i].begin());
    if (parts_[i].kind == Kind::kDisplacement) tcp_before_ = robot_.arm().leaf_frame_to_robot();
  }
}

void RobotActions::Read(std::span<double> out) const {
  for (size_t i = 0; i < parts_.size(); ++i) {
    const std::span<const double> target = robot_.controller(parts_[i].group).commanded_joint_pos();
    switch (parts_[i].kind) {
      case Kind::kTarget:
        std::ranges::copy(target, out.begin());
        break;
      case Kind::kRelative:
        std::ranges::transform(target, before_[i], out.begin(), std::minus<>());
        break;
      case Kind::kPose:
        PutPose(robot_.FkFrame(target), out);
        break;
      case Kind::kDisplacement: {
        const Eigen::Matrix<double, 6, 1> twist =
            PoseDifference(tcp_before_, robot_.FkFrame(target));
        std::copy_n(twist.data(), 6, out.begin());
        break;
      }
    }
    out = out.subspan(static_cast<size_t>(features_[i].size()));
  }
}

bool RobotActions::Has(std::string_view name) const {
  return std::ranges::any_of(features_, [&](const Feature& f) { return f.column.name == name; });
}

const RobotActions::Part& RobotActions::Find(std::string_view name) const {
  std::vector<std::string> names;
  for (size_t i = 0; i < features_.size(); ++i) {
    if (features_[i].column.name == name) return parts_[i];
    names.push_back(features_[i].column.name);
  }
  throw NotFoundError(NoSuchName("robot '" + name_ + "'", "action", name, names));
}

std::pair<std::string, GroupCommand> RobotActions::Command(std::string_view name,
                                                           std::span<const double> values) const {
  const Part& part = Find(name);
  const int64_t size = features_[static_cast<size_t>(&part - parts_.data())].size();
  if (static_cast<int64_t>(values.size()) != size)
    throw ArgumentError(
        fmt::format("action '{}' has {}, got {}", name, Counted(size, "number"), values.size()));
  for (const double value : values) {
    if (!std::isfinite(value))
      throw ArgumentError(
          fmt::format("action '{}' is not finite: [{}]", name, fmt::join(values, ", ")));
  }
  std::vector<double> numbers(values.begin(), values.end());
  switch (part.kind) {
    case Kind::kTarget:
      if (part.gripper)
        return {part.group, GroupCommand::Opening(std::clamp(numbers.at(0), 0.0, 1.0))};
      return {part.group, GroupCommand::Joints(std::move(numbers))};
    case Kind::kRelative: {
      if (!part.gripper) return {part.group, GroupCommand::RelativeJoints(std::move(numbers))};
      const double now = robot_.controller(part.group).commanded_joint_pos()[0];
      return {part.group, GroupCommand::Opening(std::clamp(now + numbers.at(0), 0.0, 1.0))};
    }
    case Kind::kPose: {
      const Quaternion q = UnitQuaternionOf(name, {numbers[3], numbers[4], numbers[5], numbers[6]});
      return {part.group, GroupCommand::LeafPose(Pose({numbers[0], numbers[1], numbers[2]}, q))};
    }
    case Kind::kDisplacement:
      break;
  }
  const Eigen::Map<const Eigen::Matrix<double, 6, 1>> twist(numbers.data());
  return {part.group, GroupCommand::LeafPose(Integrate(robot_.arm().leaf_frame_to_robot(), twist))};
}

}  // namespace robocell
