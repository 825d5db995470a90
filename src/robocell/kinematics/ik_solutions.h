// All solutions of one inverse kinematics question that can be told apart.
//
//   for (const IkResult& found : IkSolutions(chain, target, {.seed = q_now})) Look(found.q);
#pragma once

#include <functional>
#include <vector>

#include "robocell/kinematics/ik.h"

namespace robocell {

// What is found from options.max_restarts + 1 starts, filtered. Without redundant joints, where
// solutions can be counted, starts go on until 600 in a row have led to nothing new (2000 more at
// most, and none where less than 48 are allowed); else more starts find more. Each is farther than
// `separation` from all others: in at least one joint, rad (slides: lengths of the chain). Whole
// turns of a hinge are no difference. In order of options.prefer, nearest to the seed first unless
// that says otherwise. Of a chain with redundant joints these are samples of endlessly many; with a
// preference each of them has moved to where it is met best, so that they are one for each way to
// hold the arm. Deterministic. ArgumentError as Ik has it, for a separation that is not above 0,
// and for more than a million starts. `poll` is called now and then; what it throws ends the search
// and comes out of it.
std::vector<IkResult> IkSolutions(const Chain& chain, const Pose& tip_in_base,
                                  const IkOptions& options = {}, double separation = 0.05,
                                  const std::function<void()>& poll = {});

}  // namespace robocell
