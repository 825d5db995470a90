// Checks that an episode follows from its metadata. It builds the recorded scene in the recorded
// start state, applies only the recorded controls, tick by tick, and compares the result with the
// record.
//
//   const ReplayResult result = VerifyReplay(Episode("out/pick_v1/s0000_e0003"));
//   if (!result.ok()) std::cerr << result.Text() << '\n';
//
// Not for playing an episode back, nor for checking that its bytes are intact (data/verify.h).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "robocell/data/episode_reader.h"
#include "robocell/scene/scene.h"

namespace robocell {

struct ReplayOptions {
  // Largest difference that counts as equal: m, rad, m/s, rad/s, s. On the type of machine that
  // recorded the episode, with the same versions, a replay is exact to the last bits.
  double tolerance = 1e-9;
};

// A value that differs from the recorded one.
struct ReplayDifference {
  int64_t row = 0;     // row of `steps`
  int64_t tick = 0;    // row of `control`: the first one of `row`, unless `what` is the clock
  double time = 0;     // recorded, s
  std::string what;    // "joint 'joint3' of rc7/arm", "object 'target' z"
  std::string column;  // name of the recorded column
  double recorded = 0, replayed = 0;
  std::string units;
  int others = 0;  // further differing values in this row
};

struct ReplayResult {
  std::string episode;
  int64_t rows = 0, ticks = 0;  // compared without a difference
  std::optional<ReplayDifference> first = {};
  std::string versions = {};  // "recorded with mujoco 3.9.0, this is 4.0.0"; "" when equal
  bool ok() const { return !first; }
  // Returns one line, and a second one if both the values and the versions differ.
  std::string Text() const;
};

// Compares each row before its action (joint positions of all groups, object poses, joint
// velocities) and the time of every control tick. Stops at the first row or tick that differs; a
// replay that diverges differs. Throws ArgumentError if the episode does not record its scene
// (episodes of runs and environments do), SpecError if the scene has other controls or another
// state than the recorded one, the errors of building a scene, and IoError.
ReplayResult VerifyReplay(const Episode& episode, const ReplayOptions& options = {});

// Applies the recorded controls and calls `at_row` before those of each row, with the scene in the
// state of that row, until it returns false. The same errors.
void PlayControls(const Episode& episode,
                  const std::function<bool(const Scene& scene, int64_t row)>& at_row);

}  // namespace robocell
