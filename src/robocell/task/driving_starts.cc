#include "robocell/task/driving_starts.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "robocell/robot/planar_motion.h"
#include "robocell/robot/robot.h"
#include "robocell/task/base_stances.h"
#include "robocell/task/door_swings.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/refusal.h"
#include "robocell/task/work_stances.h"

namespace robocell::internal {
namespace {

constexpr int kStartDraws = 48;  // places of the robot, of which a few are tried
constexpr int kStartsTried = 4;

}  // namespace

std::optional<Pose> DrivingStartSampler::ProposeBasePose(const Robot& robot, const Support& support,
                                                         const Pose& target,
                                                         const BasePlacement& placement, Rng& rng) {
  if (!StartsAnywhere(run()))
    return StartSampler::ProposeBasePose(robot, support, target, placement, rng);
  const std::optional<Vec2> distances = DistancesInReach(robot, target.translation());
  if (!distances) return std::nullopt;
  BasePlacement here = placement;
  here.distance = rng.Uniform((*distances)[0], (*distances)[1]);
  return StartSampler::ProposeBasePose(robot, support, target, here, rng);
}

std::optional<Refusal> DrivingStartSampler::MoveBase(const Robot& robot, int scene_index,
                                                     Rng& rng) {
  if (!StartsAnywhere(run())) return std::nullopt;
  const Scene scene = robot.scene();
  Rng draws = rng.Fork("start of the way");
  scene.SyncPoses();
  const std::shared_ptr<const SceneAnnotations> known = AnnotationsOf(scene_index);
  const std::vector<Articulation> doors =
      run().start.base_blocks_doors ? std::vector<Articulation>() : DoorsOf(*known, scene);
  const std::vector<Pose> bases =
      DrawOnFloor(known->free_floor, robot.base().pose().translation().z(), kStartDraws, draws);
  const std::vector<bool> free =
      BaseStances(robot, std::max(run().start.base_clearance, kWayClearance), doors).AreFree(bases);
  FloorWays ways(robot);
  int tried = 0;
  for (size_t i = 0; i < bases.size() && tried < kStartsTried; ++i) {
    if (!free[i]) continue;
    ++tried;
    // A way there is one back.
    const std::array<FloorPlace, 1> place{PlaceOf(bases[i])};
    if (!ways.FindWay(ways.FreeOf(place))) continue;
    PutBase(robot, bases[i]);
    return std::nullopt;
  }
  return Refusal{kNoWay, "from anywhere on the floor to the object"};
}

std::shared_ptr<TaskSampler> MakeSamplerOfWork(const RunConfig& run) {
  if (DrivesItself(run.robot.config)) return std::make_shared<DrivingStartSampler>(run);
  return std::make_shared<StartSampler>(run);
}

}  // namespace robocell::internal
