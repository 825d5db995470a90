// Chains without redundant joints have solutions that can be counted: how long to look for all of
// them. For the solvers of this folder.
#pragma once

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_task.h"

namespace robocell {

// Who allows fewer starts wants to know soon, and gets no more than these.
inline constexpr int kFewStarts = 48;

// Whether starts continue beyond max_restarts, until all solutions are most likely known.
bool LooksForAll(const Chain& chain, const IkTask& task, const IkOptions& options);

// Whether more starts may lead to another (or better) solution, if start `newest` was the first to
// lead to the last such one and `begun` were tried. The search ends after `quiet` starts in a row
// without one, and after 2000 more than allowed, because singular poses have infinitely many.
bool MayFindAnother(const IkOptions& options, int newest, int begun, int quiet);

// In some joint by more than `least`: rad (whole turns are no difference), lengths of the chain.
bool AreApart(const ChainModel& chain, const JointVector& a, const JointVector& b, double least);

// Nearer solutions count as one; as near as the tolerance of the tip can distinguish; rad.
inline constexpr double kAnother = 0.05;

}  // namespace robocell
