// Does an episode follow from what it says? Builds the recorded scene, puts it into the recorded
// start, lets nothing but the recorded controls act, tick by tick, and compares what comes out with
// what was recorded.
//
//   const ReplayResult result = VerifyReplay(Episode("out/pick_v1/s0000_e0003"));
//   if (!result.ok()) std::cerr << result.Text() << '\n';
//
// Not for: playing an episode to somebody, nor whether its bytes are intact (data/verify.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "robocell/data/episode_reader.h"

namespace robocell {

struct ReplayOptions {
  // Largest difference that counts as none: m, rad, m/s, rad/s, s. On the machine type that
  // recorded it, with the same versions, a replay is exact to the last bits.
  double tolerance = 1e-9;
};

// A value that came out otherwise.
struct ReplayDifference {
  int64_t row = 0;     // of `steps`
  int64_t tick = 0;    // of `control`; its first of the row unless `what` is the clock
  double time = 0;     // recorded, s
  std::string what;    // "joint 'robot_0/joint3' of rc7/arm", "object 'target' z"
  std::string column;  // where it is recorded
  double recorded = 0, replayed = 0;
  std::string units;
  int others = 0;  // further values that differ in this row
};

struct ReplayResult {
  std::string episode;
  int64_t rows = 0, ticks = 0;  // compared without a difference
  std::optional<ReplayDifference> first = {};
  std::string versions = {};  // "recorded with mujoco 3.9.0, this is 4.0.0"; "" when they agree
  bool ok() const { return !first; }
  // One line; a second one when it differs and the versions do.
  std::string Text() const;
};

// Rows are compared before their action: joint positions of all groups, object poses, joint
// velocities; every control tick its time. Stops at the first row or tick that differs. A replay
// that diverges differs. ArgumentError when the episode does not say what it was made in (those of
// runs and environments do), SpecError when the scene has other controls or another state than was
// recorded, errors of building a scene, IoError.
ReplayResult VerifyReplay(const Episode& episode, const ReplayOptions& options = {});

}  // namespace robocell
