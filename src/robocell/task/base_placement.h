// Places a robot's base around a task's target: ranges of distance and height, a pose drawn from
// them, and the conditions that the pose has to satisfy (range, reach, clearance, visibility). Each
// condition can refuse the pose with a reason.
//
//   const BasePlacement placement = SpreadBasePlacement(range, seed, turn, attempt, rng);
//   if (const auto base = ProposeBasePose(robot, support, target, placement, {}, rng)) {
//     robot.base().SetPose(*base);
//     scene.Forward();
//     if (auto refusal = ValidateBaseReach(robot, target)) ...
//   }
//
// StartSampler (start_sampler.h) calls all of these; a custom sampler can call those that it needs.
// Distances are in metres.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/types.h"
#include "robocell/task/refusal.h"

namespace robocell {

class Hooks;

inline constexpr double kReachShare = 0.95;  // share of the robot's reach that is used

// The range of a robot's base around an object, in metres.
struct BaseRange {
  Vec2 distance = {0.3, 0.6};  // horizontal: smallest and largest
  double height_offset = 0;    // height of the base's bottom above the object
  Vec2 height_noise = {0, 0};  // added to height_offset: smallest and largest
};

// Returns the range of the run's `start`, completed by that of the task.
BaseRange BaseRangeOf(const StartConfig& start, const BaseRange& of_task);

// Throws ArgumentError for numbers that are not finite, a distance below 0, and a smallest number
// above its largest.
void RequireSound(const BaseRange& range);

// Names the owner of a number for a problem: the field of a file, or a method of a user's task.
struct NumberOwner {
  std::string field;        // "start.base_distance", or "task" for a method
  std::string method = {};  // begins the text: "the distance that base_range() of 'mine' returns, "
  std::string written = {};  // ends it: " (mine.py:7, in base_range)"
};
struct BaseRangeOwners {
  NumberOwner distance = {"start.base_distance"}, height = {"start.base_height_offset"};
};
// Returns the owners of the numbers of BaseRangeOf: a task's own ones are those that `start` leaves
// out and that are not the defaults.
BaseRangeOwners OwnersOfBaseRange(const StartConfig& start, const Hooks& task,
                                  const std::string& kind, const BaseRange& of_task);

// Adds problems for a range that goes beyond the robot's reach: StartSampler refuses all starts from
// there.
void ValidateBaseRange(const BaseRange& range, const Robot& robot, Problems& problems,
                       const BaseRangeOwners& owners = {});

struct BasePlacement {
  double distance = 0;  // horizontal distance from the target
  double height = 0;    // height of the base's bottom above the target
};
// Throws ArgumentError that names the first number that is not finite.
void RequireFinite(const BasePlacement& placement);

// Draws distance and height (the offset plus its noise) from a range: turn k gets the k-th point of
// a low-discrepancy sequence that the run's seed shifts (Cranley and Patterson 1976). Further
// attempts spread more and more around that point, so that a corner that never works does not block
// the episode.
BasePlacement SpreadBasePlacement(const BaseRange& range, uint64_t seed, uint64_t turn, int attempt,
                                  Rng& rng);

// Returns a pose for the robot's base (the bottom of its pedestal) around the target. The base
// faces the target up to `base_facing_noise`, and the robot in its present configuration keeps
// `base_clearance` from the support. Unset without such a pose.
std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                    const Pose& target_in_world, const BasePlacement& placement,
                                    const StartConfig& start, Rng& rng);

// The following conditions check the base where it stands; the scene's poses must be up to date.
// This one refuses a base whose distance from the target is outside the range.
std::optional<Refusal> ValidateBaseDistance(const Robot& robot, const Pose& target_in_world,
                                            const BaseRange& range);
// Refuses a target beyond kReachShare of the robot's reach.
std::optional<Refusal> ValidateBaseReach(const Robot& robot, const Pose& target_in_world);
// The same for a body that stays in place, such as furniture: what counts is its nearest part.
std::optional<Refusal> ValidateBaseReachOfPart(const Robot& robot, const std::string& body);
// Returns "" if one of the robots may reach to within `slack` of a place in the world, or of a
// point straight below it down to the height `lowest` (metres); else the distance of the nearest
// robot. The bound is the length of the stretched arm. Robots with a movable base reach everything.
std::string WhyOutOfReach(const std::vector<Robot>& robots, const Eigen::Vector3d& place,
                          double lowest, double slack);
// Refuses a robot that stands closer than `clearance` to anything else.
std::optional<Refusal> ValidateBaseClearance(const Scene& scene, const Robot& robot,
                                             double clearance);
// Refuses a start in which the cameras of `run.start.visible_from` do not see enough of the target.
// Throws NotFoundError for an unknown camera.
std::optional<Refusal> ValidateVisibility(const Scene& scene, const std::string& target_body,
                                          const RunConfig& run);

// Returns the image stream that an entry of `start.visible_from` names: the one of that name, else
// the first one of that camera. A camera without a stream gives a nameless one with the run's
// resolution.
CameraConfig StreamToSee(const CameraSystemConfig& cameras, const std::string& name);

}  // namespace robocell
