// What a robot contributes to a cell's features: its state (RobotFeatures), and what it is commanded
// (RobotActions), in the canonical form that all other forms of an action follow from: joint targets
// and opening, absolute; beside them the same relative to the targets before, and the arm's as TCP
// pose and twist in the robot's base frame.
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

// Units of joints of the model: "rad", "m", or all in their order; with `rate` those of their
// velocities. "" when one of them is no joint: a group of the user's own kind may have other
// coordinates.
std::string UnitsOfJoints(const mjModel* m, const std::vector<std::string>& joints, bool rate);

// Joints and targets of every group, base and TCP pose, opening of the gripper.
class RobotFeatures final : public FeatureSource {
 public:
  explicit RobotFeatures(Robot robot);

 private:
  // Error when the robot's groups are no longer those that the features were made for.
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
  // The numbers of all features, of the action that was applied since Begin().
  void Read(std::span<double> out) const;

  // Whether a name is of this robot's actions, and the command that it stands for: of which group,
  // and what. A pose is the TCP's in the base frame; a twist goes from where the TCP is now; relative
  // joints and openings go from the targets of now. ArgumentError for numbers that are not finite.
  bool Has(std::string_view name) const;
  std::pair<std::string, GroupCommand> Command(std::string_view name,
                                               std::span<const double> values) const;
  const std::string& robot() const { return name_; }

 private:
  enum class Kind { kTarget, kRelative, kPose, kTwist };
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
  std::vector<Part> parts_;                  // of each feature
  std::vector<std::vector<double>> before_;  // targets, of each feature that is relative
  Pose tcp_before_;
};

}  // namespace robocell
