#include "robocell/robot/hand_pose.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/measurement_cache.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/spec/locations.h"

namespace robocell::internal {
namespace {

constexpr double kCtrlSlack = 1e-6;  // share of a control range that rounding may exceed

// The control of one actuator of a group.
struct OneCtrl {
  size_t actuator = 0;  // index in the group
  double value = 0;
};

const RobotRecord& RobotOf(const GroupCore& group) {
  return group.scene().compiled()->robot(group.names().robot);
}

// Returns an actuator's name in the robot's own file.
std::string OwnName(const GroupCore& group, size_t actuator) {
  const std::string& name = group.names().actuators[actuator];
  const std::string& prefix = RobotOf(group).prefix;
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

// Logs once for a model that a name of a pose is an actuator's and a joint's, which would get
// different controls.
void WarnOfTwoMeanings(const GroupCore& group, const std::string& pose, const std::string& name,
                       const OneCtrl& taken) {
  const mjModel* m = group.model();
  const int joint = FindId(m, mjOBJ_JOINT, RobotOf(group).prefix + name);
  if (joint < 0) return;
  const int actuator = group.actuator_ids()[taken.actuator];
  const auto ctrl = ActsOnJoint(m, actuator) && TargetOf(m, actuator).id == joint
                        ? FreeRestingCtrl(m, actuator, Gear(m, actuator) * taken.value)
                        : std::nullopt;
  if (ctrl && std::abs(*ctrl - taken.value) <= kCtrlSlack * std::max(1.0, std::abs(*ctrl))) return;
  const std::string what = fmt::format("two meanings of {} / {}.{}", group.place(), pose, name);
  CachedMeasurement(group.scene().compiled(), what, [&] {
    LogWarn(fmt::format(
        "{}: '{}' in pose '{}' is the name of an actuator and of a joint. {:g} is the control of "
        "the actuator, not the position of the joint",
        group.place(), name, pose, taken.value));
    return std::vector<double>{};
  });
}

// Returns the control that holds a joint at a position.
OneCtrl CtrlOfJoint(const GroupCore& group, const std::string& field, const std::string& joint,
                    double position) {
  const mjModel* m = group.model();
  const int id = RequireId(m, mjOBJ_JOINT, RobotOf(group).prefix + joint, group.place());
  const std::vector<int>& ids = group.actuator_ids();
  std::vector<std::string> names;
  for (size_t i = 0; i < ids.size(); ++i) {
    names.push_back(OwnName(group, i));
    if (!ActsOnJoint(m, ids[i]) || TargetOf(m, ids[i]).id != id) continue;
    if (const auto ctrl = FreeRestingCtrl(m, ids[i], Gear(m, ids[i]) * position)) return {i, *ctrl};
    FailAtField(group, field,
                fmt::format("joint '{}' is moved by {}, which holds no position; give the control "
                            "of its actuator '{}' in the pose",
                            joint, DescribeActuator(m, ids[i]), names.back()));
  }
  FailAtField(group, field,
              fmt::format("no actuator of the hand acts on joint '{}' alone; give the controls of "
                          "actuators in the pose. Its actuators: {}",
                          joint, ListNames(names)));
}

}  // namespace

std::vector<double> CtrlOfPose(const GroupCore& group, const MoveGroupConfig& config,
                               const std::string& pose) {
  group.Bind();
  const mjModel* m = group.model();
  std::vector<double> ctrl;
  if (pose != MoveGroupConfig::kOpenPose) {
    ctrl = CtrlOfPose(group, config, MoveGroupConfig::kOpenPose);
  } else {
    const int key = group.scene().compiled()->home_key();
    for (const int input : group.ctrl_addresses()) {
      ctrl.push_back(key >= 0 ? m->key_ctrl[static_cast<ptrdiff_t>(key) * m->nu + input] : 0.0);
    }
  }
  const std::vector<std::string>& actuators = group.names().actuators;
  for (const auto& [element, value] : config.poses.at(pose).entries()) {
    const std::string field = fmt::format("poses.{}.{}", pose, element);
    const auto named = std::ranges::find(actuators, RobotOf(group).prefix + element);
    const OneCtrl one = named != actuators.end()
                            ? OneCtrl{static_cast<size_t>(named - actuators.begin()), *value}
                            : CtrlOfJoint(group, field, element, *value);
    if (named != actuators.end()) WarnOfTwoMeanings(group, pose, element, one);
    const int input = group.ctrl_addresses()[one.actuator];
    ctrl[one.actuator] = one.value;
    if (!m->actuator_ctrllimited[input]) continue;
    const mjtNum* range = m->actuator_ctrlrange + 2 * static_cast<ptrdiff_t>(input);
    const double slack = kCtrlSlack * std::max(1.0, range[1] - range[0]);
    if (one.value < range[0] - slack || one.value > range[1] + slack) {
      FailAtField(group, field,
                  fmt::format("the control {:g} is outside the range {:g} ... {:g} of actuator "
                              "'{}'",
                              one.value, range[0], range[1], OwnName(group, one.actuator)));
    }
    ctrl[one.actuator] = std::clamp(one.value, range[0], range[1]);
  }
  return ctrl;
}

void FailAtField(const GroupCore& group, const std::string& field, const std::string& message) {
  const RobotConfig& config = RobotOf(group).config;
  const std::string& name = group.names().group;
  const std::string place = config.move_groups.contains(name)
                                ? config.locations.At("move_groups." + name + "." + field)
                                : "";
  throw ArgumentError(WithPlace(place, group.place() + ": " + message));
}

}  // namespace robocell::internal
