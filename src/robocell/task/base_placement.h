// Where a robot's base stands relative to what it is to pick: chosen so that a run of few episodes
// covers the configured ranges.
#pragma once

#include <cstdint>

#include "robocell/base/rng.h"
#include "robocell/spec/run_config.h"

namespace robocell {

struct BasePlacement {
  double distance = 0;  // from the target, horizontal, metres
  double height = 0;    // of the base's bottom above the target, metres
};

// Distance and height from `base_distance` and `base_height_offset` + `base_height_noise`: turn k
// has the k-th point of a low-discrepancy sequence that the run's seed shifts (Cranley and
// Patterson 1976). Further attempts spread around it, more and more, so that a corner that never
// works does not block the episode.
BasePlacement SpreadBasePlacement(const TaskConfig& task, uint64_t seed, uint64_t turn, int attempt,
                                  Rng& rng);

}  // namespace robocell
