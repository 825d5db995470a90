// Decides which straight motions in joint space are free of collisions, and obey a constraint.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/motion/collision_model.h"
#include "robocell/motion/goal_trees.h"

namespace robocell::internal {

// Keeps a direction of a chain's tip near one of the chain's base.
struct TipAxis {
  Chain chain;
  std::vector<int> dofs;  // of each joint of the chain: index in the configuration, -1 if it stays
  JointVector present;    // values of the joints that stay
  Eigen::Vector3d in_tip, in_base;
  double tolerance = 0;  // rad

  // Returns the angle between the two directions, rad.
  double Angle(std::span<const double> q) const;
  // Moves q until the angle is within the tolerance, by damped least squares; false if it is not.
  bool Project(const std::vector<Interval>& limits, std::span<double> q) const;

 private:
  JointVector ChainValues(std::span<const double> q) const;
};

// The check of an edge, from coarse to fine, eight configurations at a time.
class PathJudge : public EdgeJudge {
 public:
  enum class Kind {
    kBold,    // spheres; parts of the robot may come near to each other
    kEngine,  // spheres, and the engine's distances where they are in doubt
  };
  PathJudge(CollisionModel* model, const JointSpace& space, const TipAxis* axis,
            const std::vector<Interval>& limits)
      : model_(*model), space_(space), axis_(axis), limits_(limits) {}

  // `step`: largest step of any joint between checked configurations, in units of the space.
  // `more`: clearance beyond the model's, m.
  void Use(Kind kind, double step, double more);

  bool IsFree(std::span<const double> a, std::span<const double> b) override;
  bool Project(std::span<double> q) override;
  // Returns true if one configuration is free.
  bool IsFree(std::span<const double> q);

 private:
  bool AreFree(int count);

  CollisionModel& model_;
  const JointSpace space_;
  const TipAxis* axis_;
  const std::vector<Interval>& limits_;
  Kind kind_ = Kind::kBold;
  double step_ = 0.0174, more_ = 0;
  std::vector<double> rows_;
};

}  // namespace robocell::internal
