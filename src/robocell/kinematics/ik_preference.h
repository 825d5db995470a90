// The secondary objective: it ranks several solutions of one query, and moves redundant joints. For
// the solvers of this folder.
#pragma once

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/ik.h"

namespace robocell::internal {

class IkPreference {
 public:
  IkPreference(const ChainModel& chain, const IkOptions& options);

  // Returns true if solutions are compared at all.
  bool any() const { return prefer_ != IkPrefer::kFirst; }
  // Returns true if solutions should be near a configuration. Searches then start at it and around
  // it.
  bool has_goal() const { return any() && prefer_ != IkPrefer::kManipulability; }
  // Returns that configuration with locked joints as in the seed; without one, the seed.
  JointVector GoalFor(const JointVector& seed) const;
  // Return the share of the distance to a goal that joint i moves in a step, and how easily it
  // moves for other joints (at most 1).
  double part(int i) const;
  double ease(int i) const { return squared_scale(i) / largest_squared_scale(); }
  // Returns where redundant joints move from q.
  JointVector GoalFrom(const JointVector& q, const JointVector& goal) const;
  // Returns the cost; lower is better.
  double Cost(const JointVector& q, const JointVector& goal) const;

 private:
  JointVector Uphill(const JointVector& q) const;
  bool counts(int i) const;
  double squared_scale(int i) const;
  double largest_squared_scale() const;

  const ChainModel& chain_;
  const IkOptions& options_;
  IkPrefer prefer_;
};

}  // namespace robocell::internal
