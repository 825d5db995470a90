#include <gtest/gtest.h>

#include <set>

#include "robocell/task/grasp_generator.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

std::set<GraspKind> KindsOf(const GraspSet& set) {
  std::set<GraspKind> kinds;
  for (const Grasp& grasp : set.grasps) kinds.insert(grasp.kind);
  return kinds;
}

TEST(TwoFingerGrasps, FindTheRimOfAMugAndTheSidesOfABottle) {
  const PickScene mug = MakePickScene(ObjectOnTheTable("mug"));
  const GraspSet of_mug = GenerateGrasps(mug.robot, "target", {.samples = 1500});
  EXPECT_TRUE(KindsOf(of_mug).contains(GraspKind::kRim));
  const PickScene bottle = MakePickScene(ObjectOnTheTable("bottle"));
  const GraspSet of_bottle = GenerateGrasps(bottle.robot, "target", {.samples = 800});
  EXPECT_TRUE(KindsOf(of_bottle).contains(GraspKind::kSide));
  for (size_t i = 1; i < of_bottle.grasps.size(); ++i)
    EXPECT_LE(of_bottle.grasps[i].score, of_bottle.grasps[i - 1].score) << "best first";
}

}  // namespace
}  // namespace robocell
