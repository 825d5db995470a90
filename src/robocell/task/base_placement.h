// Where a robot's base stands around what a task is about: the ranges of distance and height, a
// pose drawn from them, and the conditions that it has to meet (range, reach, clearance,
// visibility), each of which may refuse it with its reason.
//
//   const BasePlacement placement = SpreadBasePlacement(range, seed, turn, attempt, rng);
//   if (const auto base = ProposeBasePose(robot, support, target, placement, {}, rng)) {
//     robot.base().SetPose(*base);
//     scene.Forward();
//     if (auto refusal = ValidateBaseReach(robot, target)) ...
//   }
//
// StartSampler (start_sampler.h) calls all of it; samplers of one's own may take what they need.
// Distances are metres.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "robocell/base/rng.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/types.h"
#include "robocell/task/refusal.h"

namespace robocell {

inline constexpr double kReachShare = 0.95;  // of the robot's reach that is used

// Where a robot's base may stand around an object.
struct BaseRange {
  Vec2 distance = {0.3, 0.6};  // horizontal, smallest and largest
  double height_offset = 0;    // of the base's bottom above the object
  Vec2 height_noise = {0, 0};  // added to it, smallest and largest
};

// What a run's `start` says, else what the task says.
BaseRange BaseRangeOf(const StartConfig& start, const BaseRange& of_task);

struct BasePlacement {
  double distance = 0;  // from the target, horizontal
  double height = 0;    // of the base's bottom above the target
};
// ArgumentError names the number that is not finite.
void RequireFinite(const BasePlacement& placement);

// Draws distance and height, the offset with its noise, from a range: turn k
// has the k-th point of a low-discrepancy sequence that the run's seed shifts (Cranley and
// Patterson 1976). Further attempts spread around it, more and more, so that a corner that never
// works does not block the episode.
BasePlacement SpreadBasePlacement(const BaseRange& range, uint64_t seed, uint64_t turn, int attempt,
                                  Rng& rng);

// A pose for the robot's base (the bottom of its pedestal) around the target, facing it up to
// `base_facing_noise`, where the robot as it stands now keeps `base_clearance` from the support;
// unset when there is none.
std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                    const Pose& target_in_world, const BasePlacement& placement,
                                    const StartConfig& start, Rng& rng);

// The conditions for the base where it stands. Poses of the scene are up to date.
// The target is as far from the base as the range says.
std::optional<Refusal> ValidateBaseDistance(const Robot& robot, const Pose& target_in_world,
                                            const BaseRange& range);
// It is within kReachShare of the robot's reach.
std::optional<Refusal> ValidateBaseReach(const Robot& robot, const Pose& target_in_world);
// The robot stands at least `clearance` from everything else.
std::optional<Refusal> ValidateBaseClearance(const Scene& scene, const Robot& robot,
                                             double clearance);
// The cameras of `run.start.visible_from` see enough of the target. NotFoundError for a camera that
// is not there.
std::optional<Refusal> ValidateVisibility(const Scene& scene, const std::string& target_body,
                                          const RunConfig& run);

// The image stream that an entry of `start.visible_from` means: the one of that name, else the first
// one of that camera. A camera without a stream is seen in the run's resolution; what is returned
// then has no name.
CameraConfig StreamToSee(const CameraSystemConfig& cameras, const std::string& name);

}  // namespace robocell
