#include "robocell/spec/robot_config.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "robocell/base/suggestions.h"
#include "robocell/spec/group_controls.h"
#include "robocell/spec/shared_parts.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

// The common beginning and the numbers of names like "joint1" to "joint7".
struct Numbered {
  std::string stem;
  std::set<int> numbers;
};

std::optional<Numbered> NumberedOf(const NameList& names) {
  Numbered out;
  for (const std::string& name : names.names) {
    const size_t digits = name.find_last_not_of("0123456789") + 1;  // 0 if the name has only digits
    const size_t count = name.size() - digits;
    if (count == 0 || count > 4) return std::nullopt;
    const std::string stem = name.substr(0, digits);
    if (!out.numbers.empty() && stem != out.stem) return std::nullopt;
    out.stem = stem;
    out.numbers.insert(std::stoi(name.substr(digits)));
  }
  return out.numbers.empty() ? std::nullopt : std::optional(out);
}

// Returns ". Is 'joint4' missing?" if the other list has a number that this one lacks; "" else.
std::string WhatIsMissing(const NameList& shorter, const NameList& longer) {
  const std::optional<Numbered> few = NumberedOf(shorter), many = NumberedOf(longer);
  if (!few || !many) return "";
  std::vector<std::string> missing;
  for (const int number : many->numbers) {
    if (!few->numbers.contains(number)) missing.push_back(fmt::format("{}{}", few->stem, number));
  }
  if (missing.size() != longer.size() - shorter.size()) return "";  // their numbering differs
  return fmt::format(". {} {} missing?", missing.size() == 1 ? "Is" : "Are", ListNames(missing));
}

void ValidateArm(const MoveGroupConfig& group, Problems& problems) {
  if (group.joints.empty())
    problems.AddAt("joints", "an arm needs its joints, for example joint1..joint7");
  const bool both = !group.actuators.empty() && !group.joints.empty();
  if (both && group.actuators.size() != group.joints.size()) {
    const bool fewer_joints = group.joints.size() < group.actuators.size();
    const std::string missing = fewer_joints ? WhatIsMissing(group.joints, group.actuators)
                                             : WhatIsMissing(group.actuators, group.joints);
    problems.AddAt(
        "actuators",
        fmt::format("an arm has one actuator per joint: {} for {}{}{} If joints follow "
                    "others or servos pull tendons, leave `actuators` out: they are "
                    "found",
                    Counted(group.actuators.size(), "actuator"),
                    Counted(group.joints.size(), "joint"), missing, missing.empty() ? "." : ""));
  }
}

// Checks the names of poses and of what they set.
void ValidatePoses(const MoveGroupConfig& group, Problems& problems) {
  if (group.poses.empty()) {
    if (group.closing_pose)
      problems.AddAt("closing_pose", "is one of `poses`, which this gripper does not have");
    return;
  }
  if (group.ctrl) {
    problems.AddAt("ctrl", "and `poses` both say what opens and closes the hand; keep one of them");
  }
  const std::string closing = group.closing_pose_name();
  const std::string names = ListNames(group.poses.keys());
  if (!group.poses.contains(MoveGroupConfig::kOpenPose)) {
    problems.AddAt("poses",
                   fmt::format("has no pose 'open', that of the open hand (it has {}); add "
                               "it, or rename one",
                               names));
  }
  if (!group.poses.contains(closing)) {
    if (group.closing_pose) {
      problems.AddAt("closing_pose", NoSuchName("", "pose", closing, group.poses.keys()));
    } else {
      problems.AddAt("poses", fmt::format("has no pose 'closed' (it has {}); add it, or name the "
                                          "pose that closes the hand: `closing_pose: {}`",
                                          names, group.poses.keys().back()));
    }
  }
  if (closing == MoveGroupConfig::kOpenPose)
    problems.AddAt("closing_pose", "is the open pose; name the one that closes the hand");
  std::vector<std::string> known = group.actuators.names;
  known.insert(known.end(), group.joints.begin(), group.joints.end());
  for (const auto& [name, values] : group.poses.entries()) {
    for (const std::string& element : values->keys()) {
      if (std::ranges::find(known, element) == known.end()) {
        problems.AddAt(fmt::format("poses.{}.{}", name, element),
                       NoSuchName("", "actuator or joint of the group", element, known));
      }
    }
  }
}

void ValidateGripper(const MoveGroupConfig& group, Problems& problems) {
  if (group.actuators.empty())
    problems.AddAt("actuators", "a gripper needs the actuator that moves it");
  if (group.fingers.size() == 1) {
    problems.AddAt("fingers",
                   "a gripper has two fingers or more, this one names 1; of three and "
                   "more the first closes against the others");
  }
  if (group.distance && group.distance->closed >= group.distance->open) {
    problems.AddAt("distance", fmt::format("closed ({} m) must be smaller than open ({} m)",
                                           group.distance->closed, group.distance->open));
  }
  if (group.joint_range) {
    if (group.joints.empty())
      problems.AddAt("joint_range", "is of the group's first joint; name it in `joints`");
    if (group.joint_range->open == group.joint_range->closed) {
      problems.AddAt("joint_range",
                     fmt::format("open and closed are both {}", group.joint_range->open));
    }
  }
  if (group.ctrl && group.ctrl->open == group.ctrl->closed) {
    problems.AddAt("ctrl", fmt::format("open and closed are both {}", group.ctrl->open));
  }
  ValidatePoses(group, problems);
}

// Every key of `home: {amr: ...}` must be a group.
template <class T>
void ValidateGroupKeys(const Map<T>& map, std::string_view field,
                       const Map<MoveGroupConfig>& groups, Problems& problems) {
  Problems::Scope scope(problems, field);
  for (const auto& [key, box] : map.entries()) {
    if (!groups.contains(key))
      problems.AddAt(key, NoSuchName("", "move group", key, groups.keys()));
  }
}

// Requires each group to have a controller that its kind allows.
void ValidateControls(const RobotConfig& robot, Problems& problems) {
  Problems::Scope scope(problems, "control");
  for (const auto& [key, kind] : robot.control.entries()) {
    const MoveGroupConfig* group = robot.move_groups.find(key);
    if (!group || !IsNamed(group->kind) || !IsNamed(*kind)) continue;
    const std::string why = internal::WhyNotControlledBy(group->kind, ToString(*kind));
    if (!why.empty()) problems.AddAt(key, why);
  }
}

void ValidateLengths(const Map<std::vector<double>>& map, std::string_view field,
                     const RobotConfig& robot, bool one_for_all, Problems& problems) {
  Problems::Scope scope(problems, field);
  for (const auto& [key, box] : map.entries()) {
    const MoveGroupConfig* group = robot.move_groups.find(key);
    if (!group || group->joints.empty() || box->size() == group->joints.size()) continue;
    if (one_for_all && box->size() == 1) continue;
    const size_t joints = group->joints.size();
    std::string off;
    if (box->size() < joints) {
      const auto rest = std::next(group->joints.names.begin(), static_cast<long>(box->size()));
      off = ListNames({rest, group->joints.names.end()}) +
            (box->size() + 1 == joints ? " has none" : " have none");
    } else {
      const size_t more = box->size() - joints;
      off = more == 1 ? fmt::format("the last, {:g}, is of no joint", box->back())
                      : fmt::format("the last {} are of no joint", more);
    }
    problems.AddAt(
        key, fmt::format("has {} for the {} {}: {}. Give one for each, in this "
                         "order, radians for hinges and metres for slides{}; or correct "
                         "the group's joints",
                         Counted(box->size(), "value"),
                         joints == 1 ? std::string("joint") : fmt::format("{} joints", joints),
                         ListNames(group->joints.names), off,
                         one_for_all ? ", or one number for all" : ""));
  }
}

// Checks the groups of the configuration; elements that arms find in their model are checked where
// the model is known.
void ValidateGroupsApart(const RobotConfig& robot, Problems& problems) {
  std::vector<internal::GroupParts> groups;
  for (const auto& [name, group] : robot.move_groups.entries()) {
    groups.push_back(
        {.name = name, .joints = group->joints.names, .actuators = group->actuators.names});
  }
  for (const internal::SharedParts& shared : internal::FindSharedParts(groups))
    problems.AddAt(shared.field, shared.message);
}

// Groups may share joints, which have one start.
void ValidateHomesAgree(const RobotConfig& robot, Problems& problems) {
  std::map<std::string, std::pair<std::string, double>> stated;  // joint -> group, value
  for (const auto& [name, values] : robot.home.entries()) {
    const MoveGroupConfig* group = robot.move_groups.find(name);
    if (!group || group->joints.size() != values->size()) continue;
    for (size_t i = 0; i < values->size(); ++i) {
      const std::string& joint = group->joints[i];
      const auto [first, is_new] = stated.try_emplace(joint, name, (*values)[i]);
      const auto& [other, value] = first->second;
      if (is_new || value == (*values)[i]) continue;
      problems.AddAt(fmt::format("home.{}[{}]", name, i),
                     fmt::format("is {:g} for joint '{}', which is {:g} in home.{}; give both the "
                                 "same, or leave the one group out of `home`",
                                 (*values)[i], joint, value, other));
    }
  }
}

}  // namespace

void BaseConfig::Validate(Problems& problems) const {
  if (kind == BaseKind::kDriven || (!max_linear_speed && !max_angular_speed)) return;
  problems.AddAt(max_linear_speed ? "max_linear_speed" : "max_angular_speed",
                 fmt::format("belongs to a driven base; this one's kind is {}",
                             IsNamed(kind) ? ToString(kind) : "none"));
}

void MoveGroupConfig::Validate(Problems& problems) const {
  if (kind == MoveGroupKind::kArm) ValidateArm(*this, problems);
  if (kind == MoveGroupKind::kGripper) {
    ValidateGripper(*this, problems);
  } else if (!fingers.empty() || ctrl || distance || joint_range || !poses.empty() ||
             closing_pose) {
    problems.Add(std::string("fingers, ctrl, distance, joint_range, poses and closing_pose belong "
                             "to a gripper; this group's kind is ") +
                 ToString(kind));
  }
  if (kind != MoveGroupKind::kArm && task_space) {
    problems.AddAt("task_space",
                   std::string("belongs to an arm; this group's kind is ") + ToString(kind));
  }
}

CtrlMode ModeOf(ControlKind kind) {
  switch (kind) {
    case ControlKind::kJointVelocity:
      return CtrlMode::kVelocity;
    case ControlKind::kJointTorque:
    case ControlKind::kJointImpedance:
    case ControlKind::kCartesianImpedance:
      return CtrlMode::kTorque;
    default:
      return CtrlMode::kPosition;
  }
}

std::vector<CtrlMode> RobotConfig::used_modes() const {
  std::vector<CtrlMode> modes = {CtrlMode::kPosition};
  for (const auto& [group, kind] : control.entries()) {
    const CtrlMode mode = ModeOf(*kind);
    if (std::find(modes.begin(), modes.end(), mode) == modes.end()) modes.push_back(mode);
  }
  return modes;
}

void RobotConfig::Validate(Problems& problems) const {
  ValidateNotEmpty(name, "name", "what this kind of robot is called", problems);
  ValidateNamePart(name, "name", problems);
  for (const std::string& group : move_groups.keys())
    ValidateNamePart(group, "move_groups", problems);
  ValidateNotEmpty(model, "model", "the robot's MJCF file", problems);
  ValidateGroupKeys(home, "home", move_groups, problems);
  ValidateGroupKeys(home_noise, "home_noise", move_groups, problems);
  ValidateGroupKeys(control, "control", move_groups, problems);
  ValidateControls(*this, problems);
  ValidateLengths(home, "home", *this, false, problems);
  ValidateLengths(home_noise, "home_noise", *this, true, problems);
  ValidateGroupsApart(*this, problems);
  ValidateHomesAgree(*this, problems);
  ValidateAttachments(attachments, problems);
  std::vector<std::string> camera_names;
  for (const CameraSpec& camera : cameras) camera_names.push_back(camera.name);
  ValidateUnique(camera_names, "cameras", "name", problems);
  ValidateFtSensors(ft_sensors, problems);
  if (tcp_offset && !attachment_site) {
    problems.AddAt("tcp_offset", "is relative to attachment_site, which is not set");
  }
}

}  // namespace robocell
