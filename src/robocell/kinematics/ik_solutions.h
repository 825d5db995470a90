// Finds all distinct solutions of one inverse kinematics query.
//
//   for (const IkResult& found : IkSolutions(chain, target, {.seed = q_now})) Look(found.q);
#pragma once

#include <functional>
#include <vector>

#include "robocell/kinematics/ik.h"

namespace robocell {

// Returns the distinct solutions of options.max_restarts + 1 starts, filtered. Without redundant
// joints, where solutions can be counted, starts continue until 600 in a row found nothing new (at
// most 2000 more, and none if less than 48 are allowed). Otherwise more starts find more. Each
// solution is farther than `separation` from all others in at least one joint, rad (slides: lengths
// of the chain). Whole turns of a hinge do not count. The order is that of options.prefer, by
// default nearest to the seed first. For a chain with redundant joints these are samples of
// infinitely many; with a preference each has moved to its best place, so that there is one for
// each configuration branch. Deterministic. Throws ArgumentError as in Ik, for a separation that is
// not above 0, and for more than a million starts. `poll` is called occasionally; its exception
// ends the search and is rethrown.
std::vector<IkResult> IkSolutions(const Chain& chain, const Pose& tip_in_base,
                                  const IkOptions& options = {}, double separation = 0.05,
                                  const std::function<void()>& poll = {});

}  // namespace robocell
