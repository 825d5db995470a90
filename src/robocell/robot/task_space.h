// TaskSpace: the part of a target pose that an arm's joints have to reach, and inverse kinematics
// for it.
//
// Without a configuration it is the whole pose; arms with fewer than six degrees of freedom then
// reach the position, and the rotation as nearly as their joints allow (ik_position_first.h).
//
//   const TaskSpace task = TaskSpaceOf(robot.config(), "arm");
//   const IkResult next = task.Step(chain, target, commanded);
//
// Private to robocell.
#pragma once

#include <span>
#include <string>
#include <Eigen/Core>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik.h"
#include "robocell/spec/robot_config.h"

namespace robocell {
class Robot;
}

namespace robocell::internal {

class TaskSpace {
 public:
  TaskSpace() = default;
  explicit TaskSpace(const TaskSpaceConfig& config);

  // Sets the fields of inverse kinematics that say which part counts.
  void ApplyTo(IkOptions& options) const;
  // Returns true if something of a target does not count.
  bool is_part() const { return is_part_; }
  // Returns true if something counts less than the rest, or not at all.
  bool is_weighted() const {
    return is_part_ || config_.position_weights || config_.rotation_weights;
  }
  // Returns true if the tip may rest at another pose than the target.
  bool is_partial(const Chain& chain) const { return is_part_ || reaches_position_first(chain); }
  // Returns true if the rotation of a target is reached only as nearly as the joints allow.
  bool reaches_position_first(const Chain& chain) const;
  // Returns the pose nearest to `tip` that agrees with the target in the part that counts. Without
  // a configuration that is the target itself.
  Pose Nearest(const Pose& target, const Pose& tip) const;
  // Solves for a step of a motion (ik_step.h), near the joint values `from`.
  IkResult Step(const Chain& chain, const Pose& tip_in_base, std::span<const double> from) const;
  // Solves with other options, whose task this sets. Falls back to the position first.
  IkResult Solve(const Chain& chain, const Pose& tip_in_base, IkOptions options) const;
  // Solves for a grasp after inverse kinematics of the whole pose found nothing: the position is
  // reached, and a rotation that agrees in what counts and is within `tilt` rad of the target. Fails
  // if all of the pose counts.
  IkResult SolveWithin(const Chain& chain, const Pose& tip_in_base, std::span<const double> from,
                       double tilt) const;
  // Weighs an error of the tip and the rows of its Jacobian by what counts of `target`. Both are in
  // base axes, the linear rows first; the error leads from `tip` to `reference`, a pose on the way
  // to the target. Only the ratios of weights matter.
  void Project(const Pose& target, const Pose& reference, const Pose& tip,
               Eigen::Ref<Eigen::Vector<double, 6>> error,
               Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> jacobian) const;
  // Describes it for notes: "the position alone"; "" without a configuration.
  std::string text() const;

 private:
  bool is_part_ = false;        // something of the pose does not count
  bool is_configured_ = false;  // then few joints do not change what is asked
  TaskSpaceConfig config_;
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();
  // Divided by the largest of all, for Project.
  Eigen::Vector3d position_share_ = Eigen::Vector3d::Ones();
  Eigen::Vector3d rotation_share_ = Eigen::Vector3d::Ones();
};

// Returns that of a group of a robot; the default for a group that has none.
TaskSpace TaskSpaceOf(const RobotConfig& config, const std::string& group);
// Returns that of the robot's arm.
TaskSpace TaskSpaceOf(const Robot& robot);

// Returns true if options of inverse kinematics say themselves which part of the pose counts.
bool ChoosesPart(const IkOptions& options);

}  // namespace robocell::internal
