#include "robocell/robot/validate_config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/kinematics/reach.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/scene/actuator_kind.h"

namespace robocell::internal {
namespace {

// The allowed difference between the measured and the configured finger distance, metres.
constexpr double kDistanceTolerance = 0.005;
// The allowed ratio of the configured reach to the measured one, which is accurate to a percent or
// two.
constexpr double kMostReach = 1.1, kLeastReach = 0.3;
// Smallest change of an opening that is read from a joint, from closed to open.
constexpr double kLeastRead = 0.1;

void ValidateDistance(const ActuatedGripper& gripper, const GripperDistance& stated,
                      Problems& problems) {
  const GripperDistance measured = gripper.Measure().distance;
  if (std::abs(measured.closed - stated.closed) <= kDistanceTolerance &&
      std::abs(measured.open - stated.open) <= kDistanceTolerance)
    return;
  problems.AddAt("distance",
                 fmt::format("the fingers are {:.3f} m apart when closed and {:.3f} m when open, "
                             "not {:.3f} and {:.3f}: correct it, or leave `distance` out to "
                             "have it measured",
                             measured.closed, measured.open, stated.closed, stated.open));
}

// An opening that is read from a joint has to follow the fingers: the range may be wider or
// narrower than what the joint does, but not turned around or somewhere else.
void ValidateJointRange(const ActuatedGripper& gripper, const GripperJointRange& stated,
                        Problems& problems) {
  const GripperJointRange measured = gripper.MeasureJoint();
  const auto opening = [&](double q) {
    return std::clamp((q - stated.closed) / (stated.open - stated.closed), 0.0, 1.0);
  };
  const double open = opening(measured.open), closed = opening(measured.closed);
  if (open - closed >= kLeastRead) return;
  problems.AddAt(
      "joint_range",
      fmt::format(
          "joint '{}' is at {:.4g} when the gripper is open and at {:.4g} when it is closed, "
          "so with open: {:g} and closed: {:g} its opening is read as {:.2f} and {:.2f}: {}, "
          "or leave `joint_range` out to read it from the fingers",
          gripper.joint_names()[0], measured.open, measured.closed, stated.open, stated.closed,
          open, closed,
          closed > open ? "open and closed are swapped; exchange them" : "correct it"));
}

// `failed` receives the reason why a gripper cannot be measured as configured.
template <class Failed>
void ValidateGrippers(const Robot& robot, Problems& problems, const Failed& failed) {
  Problems::Scope groups(problems, "move_groups");
  for (const auto& [name, config] : robot.config().move_groups.entries()) {
    if ((!config->distance && !config->joint_range) || !robot.has_group(name)) continue;
    const auto* gripper = dynamic_cast<const ActuatedGripper*>(&robot.group(name));
    Problems::Scope group(problems, name);
    if (!gripper) continue;
    try {
      if (config->distance) ValidateDistance(*gripper, *config->distance, problems);
      if (config->joint_range && gripper->nq() > 0)
        ValidateJointRange(*gripper, *config->joint_range, problems);
    } catch (const Error& error) {
      failed(error);
    }
  }
}

bool HasArm(const Robot& robot) {
  const std::vector<std::string> names = robot.group_names();
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return robot.group(name).kind() == MoveGroupKind::kArm;
  });
}

// A box so wide that the arm ends above it: centimetres given as metres.
void ValidateBaseSize(const Robot& robot, Problems& problems) {
  const std::optional<Vec3>& size = robot.config().base.size;
  if (!size || !HasArm(robot)) return;
  const double reach = robot.reach();
  if (std::min((*size)[0], (*size)[1]) / 2 <= reach) return;
  problems.AddAt("base.size",
                 fmt::format("on a box of {:g} x {:g} x {:g} m the robot reaches nothing beside "
                             "it: its reach is {:.2f} m. Length, width and height are in metres",
                             (*size)[0], (*size)[1], (*size)[2], reach));
}

// A reach far from that of the TCP: centimetres or kilometres, or the value of another robot.
void ValidateReachField(const Robot& robot, Problems& problems) {
  const std::optional<double>& stated = robot.config().reach;
  if (!stated || !HasArm(robot)) return;
  const double measured = ApproximateReach(robot.chain());
  if (*stated <= kMostReach * measured && *stated >= kLeastReach * measured) return;
  problems.AddAt("reach", fmt::format("the TCP gets {:.2f} m away from the root body, not {:g} m: "
                                      "correct it, or leave `reach` out to have it measured",
                                      measured, *stated));
}

// Lists the controllers that drive this arm to joint positions.
std::string PositionControls(const Robot& robot, const std::string& arm) {
  const mjModel* m = robot.scene().model();
  bool servos = true;
  for (const std::string& name : robot.group(arm).actuator_names())
    servos &= IsPositionServo(m, FindId(m, mjOBJ_ACTUATOR, name));
  return servos ? "joint_position, relative_joint_position or joint_impedance" : "joint_impedance";
}

}  // namespace

void ValidateConfig(const Robot& robot, Problems& problems) {
  ValidateReachField(robot, problems);
  ValidateGrippers(robot, problems, [&](const Error& error) { problems.Add(error.what()); });
  ValidateBaseSize(robot, problems);
}

void ValidateDistances(const Robot& robot, Problems& problems) {
  ValidateGrippers(robot, problems, [](const Error&) {});
}

bool ValidateControllers(const Robot& robot, Problems& problems) {
  const size_t before = problems.list().size();
  Problems::Scope groups(problems, "move_groups");
  for (const auto& [name, config] : robot.config().move_groups.entries()) {
    if (config->kind != MoveGroupKind::kArm && config->kind != MoveGroupKind::kGripper) continue;
    try {
      robot.controller(name);
    } catch (const NotFoundError& error) {
      problems.AddAt(name, error.what());
    }
  }
  return problems.list().size() == before;
}

// Pose controllers move on a path of their own to the pose of a joint target.
void ValidateTakesJointPositions(const Robot& robot, Problems& problems) {
  if (!HasArm(robot)) return;
  const std::string arm = robot.arm().name();
  const Controller& controller = robot.controller(arm);
  const TargetKind kind = controller.target_kind();
  if (kind == TargetKind::kJointPositions || kind == TargetKind::kJointSteps) return;
  problems.AddAt(
      "control." + arm,
      fmt::format("the scripted expert sends the arm joint positions, and '{}' takes {}; choose {} "
                  "(an expert of your own may use other commands)",
                  controller.kind(), Describe(kind), PositionControls(robot, arm)));
}

}  // namespace robocell::internal
