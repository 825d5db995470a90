// Parts of every search for joint values: its start, and the evaluation of a configuration. For the
// solvers of this folder.
#pragma once

#include <numbers>

#include "robocell/kinematics/folded_chain.h"
#include "robocell/kinematics/ik_task.h"
#include "robocell/kinematics/transform.h"

namespace robocell::internal {

inline constexpr double kTurn = 2 * std::numbers::pi;  // rad
// Number of queries, and of starts, between two polls of a thread.
inline constexpr unsigned kPollEvery = 64;

// The seed, or the middle of the limits without one; inside the limits but for locked joints.
JointVector SeedOf(const ChainModel& chain, std::span<const double> seed,
                   const LockedJoints& locked);

// Start k > 0 of those that fill the joint space, locked joints as in the seed. With `part` < 1
// they fill that part of the space around the seed.
JointVector SpreadStart(const ChainModel& chain, const JointVector& seed,
                        const LockedJoints& locked, int k, double part = 1);

// How often a search for the target may start again: a few times only, for the best approach, when
// no stretched chain touches it.
int RestartsFor(const ChainModel& chain, const IkTask& task, const IkOptions& options,
                const Transform& target);
// How often more, when all of these failed and the best of them had this cost (squared error, rad
// and lengths of the chain): where it came near, in a corner of the limits there mostly is a way.
int MoreRestartsFor(const ChainModel& chain, const IkTask& task, const IkOptions& options,
                    const Transform& target, double best_cost);

// Whole turns do not move the tip: takes as many as bring a hinge nearest to the seed, which is in
// the limits, within its limits. A hinge beyond them must have limits that hold a whole turn.
void UnwindTowards(const FoldedChain& chain, const JointVector& seed, const LockedJoints& locked,
                   JointVector* q);

// Judges q by a fresh forward kinematics, that of Chain::Fk, in double precision and one pose at a
// time: what the kernel of the search says counts for nothing. Fills in the errors and `success`.
IkResult Judged(const Chain& chain, const Transform& target, const IkTask& task, double tolerance,
                const JointVector& q);

}  // namespace robocell::internal
