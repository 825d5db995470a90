// Robot::Apply: turns commands at the policy rate into targets of controllers.
#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/robot/move_group.h"
#include "robocell/robot/robot_state.h"
#include "robocell/robot/task_space.h"

namespace robocell {
namespace {

using Values = std::vector<double>;

Values Sum(std::span<const double> a, std::span<const double> b, double sign) {
  Values sum(a.begin(), a.end());
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += sign * b[i];
  return sum;
}

Values Clamped(Values q, const std::vector<Interval>& limits) {
  for (size_t i = 0; i < q.size(); ++i) q[i] = std::clamp(q[i], limits[i].lower, limits[i].upper);
  return q;
}

void RequireKindOfCommand(const std::string& place, const internal::GroupSlot& slot,
                          const GroupCommand& command) {
  const bool gripper = slot.own->group->kind() == MoveGroupKind::kGripper;
  if ((command.kind == GroupCommand::kOpening) == gripper) return;
  throw ArgumentError(place + (gripper ? " is a gripper: command it with an opening"
                                       : " is not a gripper: command it with joints or a pose"));
}

[[noreturn]] void ThrowOtherKind(const std::string& place, const internal::GroupSlot& slot,
                                 TargetKind got) {
  throw ArgumentError(
      fmt::format("{}: its controller '{}' takes {}, not {}; command it with those, "
                  "or choose another controller",
                  place, slot.control->controller->kind(),
                  Describe(slot.control->controller->target_kind()), Describe(got)));
}

Values PoseTarget(const Pose& pose) {
  const auto& p = pose.translation();
  const auto& q = pose.quaternion();
  return {p[0], p[1], p[2], q[0], q[1], q[2], q[3]};
}

// Returns the target for the slot's controller in the controller's own terms. Checks the values.
Values JointTarget(const std::string& place, const internal::GroupSlot& slot,
                   const GroupCommand& command) {
  RequireValues([&] { return place; }, "joint", command.values, slot.own->group->nq(),
                slot.own->group->joint_names());
  const bool relative = command.kind == GroupCommand::kRelativeJoints;
  const std::span<const double> now = slot.control->controller->commanded_joint_pos();
  switch (slot.control->controller->target_kind()) {
    case TargetKind::kJointSteps:
      return relative ? command.values : Sum(command.values, now, -1);
    case TargetKind::kJointPositions:
      if (!relative) return command.values;
      return Clamped(Sum(now, command.values, 1), CheckedJointPosLimits(*slot.own->group));
    case TargetKind::kPose:
      if (!slot.own->chain) break;
      return PoseTarget(
          slot.own->chain->Fk(relative ? Sum(now, command.values, 1) : command.values));
    default:
      break;
  }
  ThrowOtherKind(place, slot, TargetKind::kJointPositions);
}

// A pose becomes joint positions for a controller that takes joint positions.
void RequireTakesPose(const std::string& place, const internal::GroupSlot& slot) {
  const TargetKind kind = slot.control->controller->target_kind();
  if (kind == TargetKind::kPose || kind == TargetKind::kJointPositions ||
      kind == TargetKind::kJointSteps)
    return;
  ThrowOtherKind(place, slot, TargetKind::kPose);
}

Values BaseTarget(const std::string& place, const internal::GroupSlot& slot,
                  const GroupCommand& command) {
  if (slot.control->controller->target_kind() != TargetKind::kBasePose)
    ThrowOtherKind(place, slot, TargetKind::kBasePose);
  if (!IsFinite(command.pose))
    throw ArgumentError(place + ": the target pose has a number that is not finite");
  return PoseTarget(command.pose);
}

// Checks velocities and torques, for controllers that take them.
Values DirectTarget(const std::string& place, const internal::GroupSlot& slot,
                    const GroupCommand& command) {
  const TargetKind kind = command.kind == GroupCommand::kTorques ? TargetKind::kJointTorques
                                                                 : TargetKind::kJointVelocities;
  if (slot.control->controller->target_kind() != kind) ThrowOtherKind(place, slot, kind);
  RequireValues([&] { return place; }, "joint", command.values, slot.own->group->nv(),
                slot.own->group->joint_names());
  return command.values;
}

}  // namespace

Robot::ApplyResult Robot::Apply(const RobotAction& action) {
  State& state = open();
  ApplyResult result;
  std::vector<std::pair<Controller*, Values>> targets;
  for (const auto& [name, command] : action) {
    internal::GroupSlot& slot = state.Require(name);
    Controller& controller = state.RequireController(slot);
    const std::string place = state.place(slot);
    RequireKindOfCommand(place, slot, command);
    if (command.kind == GroupCommand::kOpening) {
      RequireValues([&] { return place; }, "opening", command.values, 1);
      targets.emplace_back(&controller, command.values);
    } else if (command.kind == GroupCommand::kBasePose) {
      targets.emplace_back(&controller, BaseTarget(place, slot, command));
    } else if (command.kind == GroupCommand::kPose) {
      RequireTakesPose(place, slot);
      if (!IsFinite(command.pose))
        throw ArgumentError(place + ": the target pose has a number that is not finite");
      if (controller.target_kind() == TargetKind::kPose) {
        targets.emplace_back(&controller, PoseTarget(command.pose));
        continue;
      }
      const Chain& chain = state.RequireChain(slot);
      const std::span<const double> now = controller.commanded_joint_pos();
      const internal::TaskSpace task = internal::TaskSpaceOf(state.record.config, name);
      const IkResult ik = task.Step(chain, command.pose, now);
      if (result.ok && task.is_partial(chain)) result.ik = ik;  // with the rest of the rotation
      if (!ik.success) {
        if (result.ok) result = {.ok = false, .failed_group = name, .ik = ik};
        continue;
      }
      const GroupCommand joints = GroupCommand::Joints(Values(ik.q.begin(), ik.q.end()));
      targets.emplace_back(&controller, JointTarget(place, slot, joints));
    } else if (command.kind == GroupCommand::kVelocities ||
               command.kind == GroupCommand::kTorques) {
      targets.emplace_back(&controller, DirectTarget(place, slot, command));
    } else {
      targets.emplace_back(&controller, JointTarget(place, slot, command));
    }
  }
  for (const auto& [controller, values] : targets) controller->SetTarget(values);
  return result;
}

}  // namespace robocell
