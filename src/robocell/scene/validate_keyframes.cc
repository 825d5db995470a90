#include "robocell/scene/validate_keyframes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>

#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

// For an angle that only makes sense in degrees, a length that only makes sense in millimetres, or
// limits that only make sense in radians.
std::string UnitHint(int joint_type, double value, const mjtNum* range) {
  const double metres = value / 1000;
  if (joint_type == mjJNT_SLIDE && metres >= range[0] && metres <= range[1])
    return fmt::format("; metres, and {:g} millimetres are {:g}", value, metres);
  if (joint_type != mjJNT_HINGE) return "";
  if (std::abs(value) > 2 * kPi)
    return fmt::format("; radians, and {:g} degrees are {:.4f}", value, value * kPi / 180);
  const double lower = range[0] * 180 / kPi, upper = range[1] * 180 / kPi;
  const bool read_as_degrees = lower >= -2 * kPi && upper <= 2 * kPi && upper - lower > 1;
  if (!read_as_degrees || value < lower || value > upper) return "";
  return fmt::format(
      ". Were radians read as degrees? The model's {:g} to {:g} are degrees unless it says "
      "<compiler angle=\"radian\"/>",
      lower, upper);
}

// Joints whose home a robot's file says.
std::set<std::string> ConfiguredJoints(const std::vector<RobotRecord>& robots) {
  std::set<std::string> joints;
  for (const RobotRecord& robot : robots) {
    for (const auto& [name, values] : robot.config.home.entries()) {
      const MoveGroupConfig* group = robot.config.move_groups.find(name);
      if (!group) continue;
      for (const std::string& joint : group->joints) joints.insert(robot.prefix + joint);
    }
  }
  return joints;
}

// The reference position if it is inside the limits, else the middle between them.
double NearestHome(const mjModel* model, int joint) {
  const double reference = model->qpos0[model->jnt_qposadr[joint]];
  const mjtNum* range = model->jnt_range + 2 * joint;
  const bool inside = !model->jnt_limited[joint] || (reference > range[0] && reference < range[1]);
  return inside ? reference : (range[0] + range[1]) / 2;
}

// Of a group for which neither the robot's file nor its model says a home.
void WarnOfReference(const mjModel* model, const PartKey& home, const RobotRecord& robot,
                     const std::string& group_name, const MoveGroupConfig& group, CompileLog& log) {
  std::vector<std::string> wrong;
  std::vector<double> possible;
  for (const std::string& name : group.joints) {
    const int joint = FindId(model, mjOBJ_JOINT, robot.prefix + name);
    if (joint < 0 || model->jnt_type[joint] == mjJNT_FREE || model->jnt_type[joint] == mjJNT_BALL)
      return;
    possible.push_back(NearestHome(model, joint));
    if (home.qpos.contains(robot.prefix + name)) continue;
    if (auto text = OutsideLimits(model, joint, model->qpos0[model->jnt_qposadr[joint]], name))
      wrong.push_back(std::move(*text));
  }
  if (wrong.empty()) return;
  log.Warn(fmt::format("robot '{}'", robot.name),
           fmt::format("'{0}' has no home, so it begins at the model's reference position: {1}. "
                       "Give it one: home: {{{0}: [{2:.4g}]}}",
                       group_name, fmt::join(wrong, "; "), fmt::join(possible, ", ")),
           "move_groups." + group_name);
}

}  // namespace

std::optional<std::string> OutsideLimits(const mjModel* model, int joint, double value,
                                         const std::string& shown) {
  const int type = model->jnt_type[joint];
  if (!model->jnt_limited[joint] || (type != mjJNT_HINGE && type != mjJNT_SLIDE)) return {};
  const mjtNum* range = model->jnt_range + 2 * joint;
  if (value >= range[0] - kLimitSlack && value <= range[1] + kLimitSlack) return {};
  return fmt::format("{} is outside the limits {:.6g} to {:.6g} of joint '{}'{}", value, range[0],
                     range[1], shown, UnitHint(type, value, range));
}

void ValidateKeyframes(const mjModel* model, const PartKeys& parts,
                       const std::vector<RobotRecord>& robots, CompileLog& log) {
  const std::set<std::string> configured = ConfiguredJoints(robots);
  const auto check = [&](const PartKey& key, bool is_home) {
    for (const auto& [name, values] : key.qpos) {
      const int joint = FindId(model, mjOBJ_JOINT, name);
      if (joint < 0 || values.size() != 1 || (is_home && configured.contains(name))) continue;
      const PartKey::Source& source = key.joint_sources.at(name);
      const auto wrong = OutsideLimits(model, joint, values[0], source.name);
      if (!wrong) continue;
      if (is_home) {
        log.Problem(source.place, fmt::format("keyframe 'home' of {}: {}", source.file, *wrong),
                    source.field);
      } else {
        log.WarnAt(source.file, source.place, fmt::format("keyframe '{}': {}", source.key, *wrong));
      }
    }
  };
  check(parts.home, true);
  for (const RobotRecord& robot : robots) {
    for (const auto& [name, group] : robot.config.move_groups.entries()) {
      if (!robot.config.home.find(name))
        WarnOfReference(model, parts.home, robot, name, *group, log);
    }
  }
  for (const auto& [name, key] : parts.presets) check(key, false);
}

}  // namespace robocell::internal
