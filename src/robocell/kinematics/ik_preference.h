// Which of several answers to one question is the better one, and where redundant joints go. For the
// solvers of this folder.
#pragma once

#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/ik.h"

namespace robocell {

class IkPreference {
 public:
  IkPreference(const ChainModel& chain, const IkOptions& options);

  // Whether answers are compared at all.
  bool any() const { return prefer_ != IkPrefer::kFirst; }
  // Whether there is a configuration that answers are to be near to: then searches begin there and
  // around it.
  bool has_goal() const { return any() && prefer_ != IkPrefer::kManipulability; }
  // That configuration, locked joints as in the seed; the seed where there is none.
  JointVector GoalFor(const JointVector& seed) const;
  // What part of the way to a goal joint i goes in a step, and how easily it is moved for others'
  // sake (at most 1).
  double part(int i) const;
  double ease(int i) const { return squared_scale(i) / largest_squared_scale(); }
  // Where redundant joints go from q.
  JointVector GoalFrom(const JointVector& q, const JointVector& goal) const;
  // The less the better.
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

}  // namespace robocell
