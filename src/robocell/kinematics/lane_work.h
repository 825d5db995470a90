// The lanes of one chain with the data of every search in them: takes targets and starts, returns
// joint values. For the solvers of this folder.
#pragma once

#include <optional>

#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/ik_preference.h"
#include "robocell/kinematics/lane_chain.h"
#include "robocell/kinematics/lane_kernel.h"

namespace robocell::internal {

class LaneWork {
 public:
  LaneWork(const Chain& chain, const IkOptions& options);

  const ChainModel& chain() const { return chain_; }
  const IkOptions& options() const { return options_; }
  const IkPreference& preference() const { return preference_; }
  // Returns true if arrived lanes have redundant joints that still move.
  bool settles() const { return settles_; }

  // Returns the seed, or the middle of the limits without one; inside the limits except for locked
  // joints.
  JointVector SeedOf(std::span<const double> seed) const;
  // Gives the lanes from `first` to `end` values, before any of them is stepped with others.
  void Clear(int first, int end);
  // Sets a new query for a lane; forgets the best result of the last one.
  void Aim(int lane, const Transform& tip_in_base);
  // Sets the start of the lane, within the limits; it is the best until a better one is found.
  template <class Number>  // double or float
  void Put(int lane, const Number* q);
  // Lets hinges pass limits that span a whole turn until the lane gets new values: the solution
  // differs by whole turns.
  void LetRoam(int lane);
  // Sets the target of the start with this number (0, 1, ...) for a cone.
  void AskFor(int lane, int start);
  // Measures the busy lanes (bits) and moves them on; the bits of those that have arrived.
  uint32_t Step(uint32_t busy) {
    return StepLanes(folded_, limits_, busy, &state_, lane_task_ ? &*lane_task_ : nullptr) & busy;
  }
  // Makes the lane's redundant joints go to the preference's goal from now on, or stops that.
  void Pull(int lane, const JointVector& goal);
  void LetGo(int lane) { lane_task_->pull[lane] = 0; }
  IkResult Judge(const Transform& target, const JointVector& q) const {
    return Judged(original_, target, task_, options_.tolerance, q);
  }

  // Return joint values of a lane: the present ones, and the best since Aim. Locked joints equal
  // the seed's to the bit, hinges are in the turn nearest to it.
  JointVector Now(int lane, const JointVector& seed) const { return Taken(state_.q, lane, seed); }
  JointVector Best(int lane, const JointVector& seed) const {
    return Taken(state_.best_q, lane, seed);
  }
  double best_cost(int lane) const { return state_.best_cost[lane]; }
  // Returns the squared error before the last step.
  double cost(int lane) const { return state_.distance2[lane] + state_.turn2[lane]; }
  // Returns true if the last step has most likely arrived: near a target, the error after a step is
  // a part of the square of the error before it.
  bool IsLikelyThere(int lane) const { return cost(lane) <= likely_cost_; }

  // Returns true if the start with this number (0, 1, ...), measured `age` times in the lane,
  // should be given up: it converged too slowly, or took too long.
  bool IsHopeless(int lane, int start, int age) const;
  // Returns the table's starts for a target; null if it has none, because it covers no locked
  // joints.
  const StartTable* table() const;
  // Returns the part of the target that starts should be near to.
  StartTable::Aim AimOfStarts(const Transform& tip_in_base) const {
    return StartTable::At(tip_in_base, task_.position_only, task_.swing ? &task_.axis : nullptr);
  }
  // Returns how often a search may restart.
  int RestartsFor(const Transform& tip_in_base) const;
  // Returns the number of additional restarts if all of these failed with this best cost.
  int MoreRestartsFor(const Transform& tip_in_base, double best_cost) const;

 private:
  // Returns the share of a step that the joint takes: 1, or less if its limits are close together.
  double ShareOf(int joint) const;
  void AimTask(int lane, const Eigen::Matrix3d& target_axes);
  JointVector Taken(const double (&rows)[kMaxChainJoints][kMaxLanes], int lane,
                    const JointVector& seed) const;

  const Chain& original_;
  const ChainModel& chain_;
  const LaneChain& lane_chain_;
  const FoldedChain& folded_;
  const IkOptions& options_;
  IkTask task_;
  IkPreference preference_;
  bool any_locked_ = false;
  bool settles_ = false;
  LaneOptions limits_;
  double likely_cost_ = 0;
  LaneState state_;
  std::optional<LaneTask> lane_task_;  // set for queries with axes, cones or weights
};

}  // namespace robocell::internal
