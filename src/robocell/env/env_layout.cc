#include "robocell/env/env_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/base/units.h"

namespace robocell {
namespace {

constexpr double kPositionSlack = 0.05;  // of what an arm can reach, m

// No configuration puts the TCP farther than this from the robot's base.
double FarthestTcp(const Robot& robot) {
  const ChainModel& chain = robot.chain().model();
  return chain.joints[0].fixed.translation.norm() + chain.reach_bound + kPositionSlack;
}

class Builder {
 public:
  explicit Builder(const EnvConfig& config) : config_(config) {}

  void Add(const std::string& name, const Robot& robot) {
    RobotLayout layout{.robot = name, .command = CommandName(config_.control_mode)};
    layout.has_gripper = robot.has_gripper() || config_.has_mounted_gripper(name);
    layout.action = AddAction(robot);
    if (layout.has_gripper) layout.gripper_action = Append(out_.action, 0, 1);
    const double radius = FarthestTcp(robot);
    layout.tquat = AddPosition(out_.observation, robot, radius);
    for (int i = 0; i < 4; ++i, ++layout.tquat.size) Append(out_.observation, -1, 1);
    layout.xyzrpy = AddPosition(out_.observation, robot, radius);
    for (const double most : {kPi, kPi / 2, kPi}) {
      Append(out_.observation, -most, most);
      ++layout.xyzrpy.size;
    }
    layout.joints = AddJoints(out_.observation, robot, kJointSlack);
    if (layout.has_gripper) layout.gripper = Append(out_.observation, 0, 1);
    out_.robots.push_back(std::move(layout));
  }

  void AddObject(const std::string& name) {
    ObjectLayout layout{.object = name, .tquat = {out_.observation.size(), 7}};
    for (int i = 0; i < 3; ++i) Append(out_.observation, -kFarthestObject, kFarthestObject);
    for (int i = 0; i < 4; ++i) Append(out_.observation, -1, 1);
    out_.objects.push_back(std::move(layout));
  }

  void AddSignals(const std::vector<TaskSignal>& signals) {
    out_.all_signals = {out_.observation.size(), 0};
    for (const TaskSignal& signal : signals) {
      RequireSignal(signal);
      const auto size = static_cast<int>(signal.lower.size());
      out_.signals.push_back({signal.name, {out_.observation.size(), size}});
      for (int i = 0; i < size; ++i) Append(out_.observation, signal.lower[i], signal.upper[i]);
      out_.all_signals.size += size;
    }
  }

  EnvLayout Take() { return std::move(out_); }

 private:
  void RequireSignal(const TaskSignal& signal) const {
    bool is_range = signal.lower.size() == signal.upper.size() && !signal.lower.empty();
    for (size_t i = 0; is_range && i < signal.lower.size(); ++i)
      is_range = signal.lower[i] <= signal.upper[i];
    if (is_range) return;
    throw ArgumentError(
        fmt::format("environment '{}': signal '{}' of task '{}' needs a range: as many lower as "
                    "upper bounds, and none above the other",
                    config_.name, signal.name, config_.task->kind()));
  }

  static std::string CommandName(ControlMode mode) {
    return mode == ControlMode::kJoints          ? "joints"
           : mode == ControlMode::kCartesianTrpy ? "xyzrpy"
                                                 : "tquat";
  }

  static int Append(VectorRange& range, double lower, double upper) {
    range.lower.push_back(lower);
    range.upper.push_back(upper);
    return range.size() - 1;
  }

  VectorPart AddJoints(VectorRange& range, const Robot& robot, double slack) const {
    VectorPart part{range.size(), robot.n_joints()};
    for (const Interval& limit : CommandLimits(robot))
      Append(range, limit.lower - slack, limit.upper + slack);
    return part;
  }

  // Where the TCP can be, in the shared base frame.
  VectorPart AddPosition(VectorRange& range, const Robot& robot, double radius) const {
    const Pose base = robot.scene().shared_base_frame_to_world().inverse() * robot.base_in_world();
    VectorPart part{range.size(), 3};
    for (int i = 0; i < 3; ++i)
      Append(range, base.translation()[i] - radius, base.translation()[i] + radius);
    return part;
  }

  VectorPart AddAction(const Robot& robot) {
    const VectorPart part =
        config_.control_mode == ControlMode::kJoints ? AddJointAction(robot) : AddPosition(robot);
    return config_.control_mode == ControlMode::kJoints ? part : AddRotation(part);
  }

  VectorPart AddJointAction(const Robot& robot) {
    if (config_.relative_to == RelativeTo::kNone) return AddJoints(out_.action, robot, 0);
    const VectorPart part{out_.action.size(), robot.n_joints()};
    for (const Interval& limit : CommandLimits(robot)) {
      const double most = config_.relative_to == RelativeTo::kLastStep
                              ? config_.step_limit().rotation
                              : limit.upper - limit.lower;
      Append(out_.action, -most, most);
    }
    return part;
  }

  VectorPart AddPosition(const Robot& robot) {
    if (config_.relative_to == RelativeTo::kNone)
      return AddPosition(out_.action, robot, robot.reach());
    const double most = config_.relative_to == RelativeTo::kLastStep
                            ? config_.step_limit().translation
                            : 2 * robot.reach();
    const VectorPart part{out_.action.size(), 3};
    for (int i = 0; i < part.size; ++i) Append(out_.action, -most, most);
    return part;
  }

  VectorPart AddRotation(VectorPart part) {
    const bool quaternion = config_.control_mode == ControlMode::kCartesianTquat;
    double most = quaternion ? 1 : kPi;
    if (!quaternion && config_.relative_to == RelativeTo::kLastStep)
      most = std::min(most, config_.step_limit().rotation);
    for (int i = 0; i < (quaternion ? 4 : 3); ++i, ++part.size) Append(out_.action, -most, most);
    return part;
  }

  const EnvConfig& config_;
  EnvLayout out_;
};

}  // namespace

std::vector<Interval> CommandLimits(const Robot& robot) {
  std::vector<Interval> limits = robot.joint_limits();
  for (size_t i = 0; i < limits.size(); ++i) {
    if (std::isfinite(limits[i].lower) && std::isfinite(limits[i].upper)) continue;
    if (robot.chain().joints()[i].type == ChainJointType::kSlide) {
      throw ArgumentError(fmt::format(
          "robot '{}': slide joint '{}' has no limits, so that no range can be given for it; set "
          "one in `edits`: {{joint: {}, range: [0, 1]}}",
          robot.name(), robot.joint_names()[i], robot.joint_names()[i]));
    }
    limits[i] = {-2 * kPi, 2 * kPi};
  }
  return limits;
}

EnvLayout MakeEnvLayout(const EnvConfig& config, const std::vector<Robot>& robots,
                        const Task* task) {
  Builder builder(config);
  const std::vector<std::string> names = config.robots.keys();
  for (size_t i = 0; i < robots.size(); ++i) builder.Add(names[i], robots[i]);
  if (task) {
    for (const std::string& object : task->objects()) builder.AddObject(object);
    builder.AddSignals(task->signals());
  }
  return builder.Take();
}

std::string NameOfObservation(const EnvLayout& layout, int i) {
  std::string name = fmt::format("number {}", i);
  const auto look = [&](const VectorPart& part, const std::string& path) {
    if (i >= part.begin && i < part.begin + part.size)
      name = fmt::format("{}[{}]", path, i - part.begin);
  };
  for (const RobotLayout& robot : layout.robots) {
    look(robot.tquat, robot.robot + ".tquat");
    look(robot.xyzrpy, robot.robot + ".xyzrpy");
    look(robot.joints, robot.robot + ".joints");
    if (robot.has_gripper) look({robot.gripper, 1}, robot.robot + ".gripper");
  }
  for (const ObjectLayout& object : layout.objects)
    look(object.tquat, "objects." + object.object + ".tquat");
  for (const SignalLayout& signal : layout.signals) look(signal.part, "task." + signal.name);
  return name;
}

}  // namespace robocell
