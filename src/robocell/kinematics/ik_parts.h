// The common parts of searches for joint values: the start, and the evaluation of a configuration.
// For the solvers of this folder.
#pragma once

#include <numbers>

#include "robocell/kinematics/folded_chain.h"
#include "robocell/kinematics/ik_task.h"
#include "robocell/kinematics/transform.h"

namespace robocell::internal {

inline constexpr double kTurn = 2 * std::numbers::pi;  // rad
// Number of queries, and of starts, between two polls of a thread.
inline constexpr unsigned kPollEvery = 64;

// Returns the seed, or the middle of the limits without one; inside the limits except for locked
// joints.
JointVector SeedOf(const ChainModel& chain, std::span<const double> seed,
                   const LockedJoints& locked);

// Returns start k > 0 of those that fill the joint space, with locked joints as in the seed. With
// `part` < 1 they fill that part of the space around the seed.
JointVector SpreadStart(const ChainModel& chain, const JointVector& seed,
                        const LockedJoints& locked, int k, double part = 1);

// Returns how often a search for the target may restart: only a few times, for the best approach,
// if the stretched chain does not reach it.
int RestartsFor(const ChainModel& chain, const IkTask& task, const IkOptions& options,
                const Transform& target);
// Returns the number of additional restarts, if all of these failed and the best of them had this
// cost (squared error, rad and lengths of the chain): a start that came near usually means a
// solution in a corner of the limits.
int MoreRestartsFor(const ChainModel& chain, const IkTask& task, const IkOptions& options,
                    const Transform& target, double best_cost);

// Whole turns do not move the tip: adds those that bring a hinge nearest to the seed, which is
// within the limits, and keep it within its limits. The limits of a hinge beyond them must span a
// whole turn.
void UnwindTowards(const FoldedChain& chain, const JointVector& seed, const LockedJoints& locked,
                   JointVector* q);

// Judges q by a fresh forward kinematics, that of Chain::Fk, in double precision and one pose at a
// time: errors from the search kernel do not count. Sets the errors and `success`.
IkResult Judged(const Chain& chain, const Transform& target, const IkTask& task, double tolerance,
                const JointVector& q);

}  // namespace robocell::internal
