// The features of a robot in a cell: its state (RobotFeatures) and its commands (RobotActions) in
// the canonical form from which all other forms of an action follow: absolute joint targets and
// opening; also the same relative to the previous targets, and the arm's TCP pose and twist in the
// robot's base frame.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/robot/action.h"
#include "robocell/robot/robot.h"

namespace robocell {

// Returns the units of joints of the model: "rad", "m", or all in order; with `rate` those of their
// velocities. "" if one of them is not a joint: a custom group may have other coordinates.
std::string UnitsOfJoints(const mjModel* m, const std::vector<std::string>& joints, bool rate);

// Returns the names that elements of the scene have in the robot's own model: those of a robot are
// the same in every scene.
std::vector<std::string> OwnNames(const Robot& robot, const std::vector<std::string>& elements);

// Features: joints and targets of every group, base and TCP pose, opening of the gripper. Their
// ranges are those of the joints and of the gripper, and a tenth more at both ends.
class RobotFeatures final : public FeatureSource {
 public:
  explicit RobotFeatures(Robot robot);

 private:
  // Throws Error if the robot's groups have changed since the features were made.
  void ReadNumbers(std::span<double> out) override;
  struct Group {
    std::string name;
    std::shared_ptr<MoveGroup> group;  // the one that the features were made for
    int nq, nv, targets;
  };
  void AddGroup(const std::string& name);
  void RequireSameGroups() const;

  Robot robot_;
  std::vector<Group> groups_;
  bool has_arm_ = false, has_gripper_ = false;
};

class RobotActions {
 public:
  explicit RobotActions(Robot robot);

  const std::vector<Feature>& features() const { return features_; }
  // Remembers the targets and the TCP's pose: call it before the action is applied.
  void Begin();
  // Writes the numbers of all features, for the action applied since Begin().
  void Read(std::span<double> out) const;

  // Has returns true if a name is one of this robot's actions; the other functions return its group
  // and command. A pose is that of the TCP in the base frame; a twist starts at the present TCP;
  // relative joints and openings start at the present targets. Throws ArgumentError for numbers
  // that are not finite.
  bool Has(std::string_view name) const;
  std::pair<std::string, GroupCommand> Command(std::string_view name,
                                               std::span<const double> values) const;
  const std::string& robot() const { return name_; }

 private:
  enum class Kind { kTarget, kRelative, kPose, kDisplacement };
  struct Part {
    std::string group;
    Kind kind;
    bool gripper;
  };
  void Add(Feature feature, Part part);
  const Part& Find(std::string_view name) const;

  Robot robot_;
  std::string name_;
  std::vector<Feature> features_;
  std::vector<Part> parts_;                  // parts of each feature
  std::vector<std::vector<double>> before_;  // previous targets of each relative feature
  Pose tcp_before_;
};

}  // namespace robocell
