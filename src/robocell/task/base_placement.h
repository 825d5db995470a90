// Where a robot's base stands relative to what it is to pick: chosen so that a run of few episodes
// covers the configured ranges.
#pragma once

#include <cstdint>

#include "robocell/base/rng.h"
#include "robocell/spec/types.h"

namespace robocell {

// Where a robot's base may stand around an object.
struct BaseRange {
  Vec2 distance = {0.3, 0.6};  // horizontal, metres, smallest and largest
  double height_offset = 0;    // of the base's bottom above the object, metres
  Vec2 height_noise = {0, 0};  // added to it, metres, smallest and largest
};

struct BasePlacement {
  double distance = 0;  // from the target, horizontal, metres
  double height = 0;    // of the base's bottom above the target, metres
};

// Draws distance and height, the offset with its noise, from a range: turn k
// has the k-th point of a low-discrepancy sequence that the run's seed shifts (Cranley and
// Patterson 1976). Further attempts spread around it, more and more, so that a corner that never
// works does not block the episode.
BasePlacement SpreadBasePlacement(const BaseRange& range, uint64_t seed, uint64_t turn, int attempt,
                                  Rng& rng);

}  // namespace robocell
