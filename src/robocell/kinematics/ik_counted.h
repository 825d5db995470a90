// Chains without redundant joints have solutions that can be counted: how long to look for all of
// them. For the solvers of this folder.
#pragma once

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_task.h"

namespace robocell {

// Who allows fewer starts wants to know soon, and gets no more than these.
inline constexpr int kFewStarts = 48;

// Whether starts go on beyond those that are allowed, until all solutions are most likely known.
bool LooksForAll(const Chain& chain, const IkTask& task, const IkOptions& options);

// Whether more starts may lead to another solution (a better one), when start `newest` was the
// first to lead to the last such one and `begun` were tried: `quiet` starts in a row that lead to
// none are enough, and 2000 more than are allowed, as singular poses have endlessly many.
bool MayFindAnother(const IkOptions& options, int newest, int begun, int quiet);

// In some joint by more than `least`: rad (whole turns are no difference), lengths of the chain.
bool AreApart(const ChainModel& chain, const JointVector& a, const JointVector& b, double least);

// Nearer ones are one and the same, as near as the tolerance of the tip tells; rad.
inline constexpr double kAnother = 0.05;

}  // namespace robocell
