#include "robocell/env/env_layout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/env/base_frame.h"
#include "robocell/env/mounted_gripper.h"
#include "robocell/features/chosen_features.h"
#include "robocell/features/robot_features.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/task/task_features.h"

namespace robocell {
namespace {

constexpr double kPositionSlack = 0.05;  // beyond an arm's reach, m

// Returns a bound of the TCP's distance from the robot's base in all configurations.
double FarthestTcp(const Robot& robot) {
  const ChainModel& chain = robot.chain().model();
  return chain.joints[0].fixed.translation.norm() + chain.reach_bound + kPositionSlack;
}

// The range of numbers.
struct Bounds {
  std::vector<double> lower, upper;

  void Add(double least, double most, int count = 1) {
    lower.insert(lower.end(), static_cast<size_t>(count), least);
    upper.insert(upper.end(), static_cast<size_t>(count), most);
  }
};

const std::vector<std::string> kTquatNames = {"x", "y", "z", "qx", "qy", "qz", "qw"};
const std::vector<std::string> kTrpyNames = {"x", "y", "z", "roll", "pitch", "yaw"};
constexpr const char* kSharedBase = "shared base frame";

std::string Words(RelativeTo relative_to) {
  switch (relative_to) {
    case RelativeTo::kLastStep:
      return "Added to where the robot was last sent.";
    case RelativeTo::kConfiguredOrigin:
      return "Added to where the robot was at the reset.";
    case RelativeTo::kNone:
      break;
  }
  return "Where the robot is sent.";
}

VectorRange RangeOf(const FeatureSchema& schema) {
  VectorRange range;
  for (const Feature& feature : schema.features()) {
    range.lower.insert(range.lower.end(), feature.lower.begin(), feature.lower.end());
    range.upper.insert(range.upper.end(), feature.upper.begin(), feature.upper.end());
  }
  return range;
}

class Builder {
 public:
  explicit Builder(const EnvConfig& config) : config_(config) {}

  void Add(const Robot& robot) {
    const std::string name = internal::ActingName(robot);
    RobotLayout layout{.robot = name, .command = CommandName(config_.control_mode)};
    layout.has_gripper = robot.has_gripper() || internal::CarriesMountedGripper(config_, robot);
    AddActions(robot, layout);
    AddPoses(robot, layout);
    Bounds joints;
    for (const Interval& limit : CommandLimits(robot))
      joints.Add(limit.lower - kJointSlack, limit.upper + kJointSlack);
    layout.joints = Observe({name, "joints"}, JointColumn(robot), std::move(joints));
    if (layout.has_gripper)
      layout.gripper = Observe({name, "gripper"}, OpeningColumn(), {{0}, {1}}).begin;
    out_.robots.push_back(std::move(layout));
  }

  void AddObject(const std::string& name) {
    Bounds bounds;
    bounds.Add(-kFarthestObject, kFarthestObject, 3);
    bounds.Add(-1, 1, 4);
    const VectorPart part = Observe({"objects", name, "tquat"}, TquatColumn("Pose of the object."),
                                    std::move(bounds), FeatureRole::kPrivileged, "object " + name);
    out_.objects.push_back({name, part});
  }

  void AddSignals(const FeatureSource& signals) {
    out_.all_signals = {static_cast<int>(out_.observed.size()), static_cast<int>(signals.size())};
    for (const Feature& signal : signals.features()) {
      const std::string name = signal.column.name.substr(signal.column.name.find('/') + 1);
      out_.signals.push_back({name, ObserveAsIs({"task", name}, signal), signal.column.shape});
    }
  }

  void AddFeatures(const internal::ChosenFeatures& chosen) {
    out_.all_features = {static_cast<int>(out_.observed.size()), static_cast<int>(chosen.size())};
    for (size_t i = 0; i < chosen.keys().size(); ++i) {
      const Feature& feature = chosen.features()[i];
      const std::string& key = chosen.keys()[i];
      out_.features.push_back({key, ObserveAsIs({"features", key}, feature), feature.column.shape});
    }
  }

  EnvLayout Take() {
    out_.observation = RangeOf(out_.observed);
    out_.action = RangeOf(out_.commanded);
    return std::move(out_);
  }

 private:
  static std::string CommandName(ControlMode mode) {
    return mode == ControlMode::kJoints          ? "joints"
           : mode == ControlMode::kCartesianTrpy ? "xyzrpy"
                                                 : "tquat";
  }

  // Appends a feature and its path in the dictionaries, and returns the part of its numbers.
  static VectorPart Append(FeatureSchema& schema, std::vector<std::vector<std::string>>& paths,
                           const char* kind, std::vector<std::string> path, ColumnSpec column,
                           Bounds bounds, FeatureRole role, const std::string& source) {
    column.name = fmt::format("{}/{}", kind, fmt::join(path, "/"));
    const VectorPart part{static_cast<int>(schema.size()), static_cast<int>(bounds.lower.size())};
    schema.Add({.column = std::move(column),
                .role = role,
                .lower = std::move(bounds.lower),
                .upper = std::move(bounds.upper),
                .source = source});
    paths.push_back(std::move(path));
    return part;
  }

  VectorPart Observe(std::vector<std::string> path, ColumnSpec column, Bounds bounds,
                     FeatureRole role = FeatureRole::kObservation, const std::string& source = "") {
    const std::string from = source.empty() ? "robot " + path.front() : source;
    column.shape = {static_cast<int64_t>(bounds.lower.size())};
    return Append(out_.observed, out_.observed_paths, "observation", std::move(path),
                  std::move(column), std::move(bounds), role, from);
  }

  // Appends a feature in its own shape.
  VectorPart ObserveAsIs(std::vector<std::string> path, const Feature& feature) {
    Bounds bounds{feature.lower, feature.upper};
    constexpr double kAny = std::numeric_limits<double>::infinity();
    if (bounds.lower.empty()) bounds.Add(-kAny, kAny, static_cast<int>(feature.size()));
    return Append(out_.observed, out_.observed_paths, "observation", std::move(path),
                  feature.column, std::move(bounds), feature.role, feature.source);
  }

  static ColumnSpec TquatColumn(const std::string& description) {
    return {
        .units = "m, 1", .frame = kSharedBase, .names = kTquatNames, .description = description};
  }

  static ColumnSpec JointColumn(const Robot& robot) {
    const std::vector<std::string>& names = robot.joint_names();
    return {.units = UnitsOfJoints(robot.scene().model(), names, false),
            .names = OwnNames(robot, names)};
  }

  static ColumnSpec OpeningColumn() {
    return {.units = "1", .names = {"opening"}, .description = "0 closed, 1 open."};
  }

  // Returns the bounds of the TCP's position, in the shared base frame.
  static Bounds PositionBounds(const Robot& robot, double reach) {
    const Pose base = internal::BaseInSharedFrame(robot);
    const double radius = reach + internal::BaseTravel(robot).value_or(0);
    Bounds bounds;
    for (int i = 0; i < 3; ++i)
      bounds.Add(base.translation()[i] - radius, base.translation()[i] + radius);
    return bounds;
  }

  void AddPoses(const Robot& robot, RobotLayout& layout) {
    const double radius = FarthestTcp(robot);
    Bounds tquat = PositionBounds(robot, radius), xyzrpy = PositionBounds(robot, radius);
    tquat.Add(-1, 1, 4);
    layout.tquat =
        Observe({layout.robot, "tquat"}, TquatColumn("Pose of the TCP."), std::move(tquat));
    for (const double most : {internal::kPi, internal::kPi / 2, internal::kPi})
      xyzrpy.Add(-most, most);
    layout.xyzrpy = Observe({layout.robot, "xyzrpy"},
                            {.units = "m, rad",
                             .frame = kSharedBase,
                             .names = kTrpyNames,
                             .description = "Pose of the TCP."},
                            std::move(xyzrpy));
  }

  void AddActions(const Robot& robot, RobotLayout& layout) {
    const auto command = [&](const std::string& key, ColumnSpec column, Bounds bounds) {
      column.shape = {static_cast<int64_t>(bounds.lower.size())};
      return Append(out_.commanded, out_.commanded_paths, "action", {layout.robot, key},
                    std::move(column), std::move(bounds), FeatureRole::kAction,
                    "robot " + layout.robot);
    };
    const bool is_joints = config_.control_mode == ControlMode::kJoints;
    ColumnSpec column = is_joints ? JointColumn(robot) : TquatColumn("");
    column.description = Words(config_.relative_to);
    if (config_.control_mode == ControlMode::kCartesianTrpy) {
      column.units = "m, rad";
      column.names = kTrpyNames;
    }
    layout.action = command(layout.command, std::move(column),
                            is_joints ? JointActionBounds(robot) : PoseActionBounds(robot));
    if (layout.has_gripper)
      layout.gripper_action = command("gripper", OpeningColumn(), {{0}, {1}}).begin;
  }

  Bounds JointActionBounds(const Robot& robot) const {
    Bounds bounds;
    for (const Interval& limit : CommandLimits(robot)) {
      if (config_.relative_to == RelativeTo::kNone) {
        bounds.Add(limit.lower, limit.upper);
        continue;
      }
      const double most = config_.relative_to == RelativeTo::kLastStep
                              ? config_.step_limit().rotation
                              : limit.upper - limit.lower;
      bounds.Add(-most, most);
    }
    return bounds;
  }

  Bounds PoseActionBounds(const Robot& robot) const {
    Bounds bounds;
    if (config_.relative_to == RelativeTo::kNone) {
      bounds = PositionBounds(robot, robot.reach());
    } else {
      const double most = config_.relative_to == RelativeTo::kLastStep
                              ? config_.step_limit().translation
                              : 2 * robot.reach();
      bounds.Add(-most, most, 3);
    }
    const bool quaternion = config_.control_mode == ControlMode::kCartesianTquat;
    double most = quaternion ? 1 : internal::kPi;
    if (!quaternion && config_.relative_to == RelativeTo::kLastStep)
      most = std::min(most, config_.step_limit().rotation);
    bounds.Add(-most, most, quaternion ? 4 : 3);
    return bounds;
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
    limits[i] = {-2 * internal::kPi, 2 * internal::kPi};
  }
  return limits;
}

EnvLayout MakeEnvLayout(const EnvConfig& config, const std::vector<Robot>& robots, const Task* task,
                        const FeatureSource& signals, const internal::ChosenFeatures& chosen) {
  Builder builder(config);
  for (const Robot& robot : robots) builder.Add(robot);
  if (task && !robots.empty()) {
    for (const std::string& object : ObjectsOf(*task, robots.front().scene()))
      builder.AddObject(object);
  }
  builder.AddSignals(signals);
  builder.AddFeatures(chosen);
  return builder.Take();
}

std::string NameOfObservation(const EnvLayout& layout, int i) {
  int begin = 0;
  for (size_t part = 0; part < layout.observed.features().size(); ++part) {
    const auto size = static_cast<int>(layout.observed.features()[part].size());
    if (i < begin + size)
      return fmt::format("{}[{}]", fmt::join(layout.observed_paths[part], "."), i - begin);
    begin += size;
  }
  return fmt::format("number {}", i);
}

}  // namespace robocell
