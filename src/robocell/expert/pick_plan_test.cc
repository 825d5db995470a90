#include "robocell/expert/pick_plan.h"

#include <gtest/gtest.h>

#include "robocell/testing/menagerie.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

PickPlanRequest RequestFor(const PickScene& pick) {
  return {
      .start = pick.home(), .home = pick.home(), .tcp_now = pick.robot.tcp_in_world(), .avoid = {}};
}

// Checks the whole approach at a fifth of the planner's step, without its clearance.
void ExpectFree(PlanningScene& planning, const JointPath& path) {
  for (size_t i = 1; i < path.size(); ++i) {
    const FreeFunction is_free = [&](const JointVector& q) {
      return planning.IsFree(q, {.gap = planning.shape().open_gap()});
    };
    EXPECT_TRUE(EdgeIsFree(path[i - 1], path[i], is_free, kEdgeStep / 5));
  }
}

TEST(PlanPick, TheApproachIsCollisionFree) {
  for (const std::string& kind : DefaultObjectKinds()) {
    const PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    PlanningScene planning = pick.planning();
    Rng rng = Rng::Stream(1, kind);
    const PickPlanResult result = PlanPick(planning, RequestFor(pick), rng);
    ASSERT_TRUE(result.plan) << kind << ": " << result.failure;
    EXPECT_EQ(result.plan->approach.front(), pick.home());
    EXPECT_EQ(result.plan->approach.back(), result.plan->motion.down.front());
    ExpectFree(planning, result.plan->approach);
  }
}

// The xArm's home is stretched out beside the table's edge: no straight path leads over it.
TEST(PlanPick, FindsDetours) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"), "xarm7_pick.yaml", 0.5);
  int detours = 0;
  for (int seed = 0; seed < 4; ++seed) {
    PickScene lower = pick;
    Pose base = lower.robot.base().pose();
    base = Pose(base.translation() - Eigen::Vector3d(0.02 * seed, 0, 0.08 + 0.03 * seed),
                base.quaternion());
    lower.robot.base().SetPose(base);
    lower.scene.Forward();
    PlanningScene planning = lower.planning();
    if (!planning.IsFree(lower.home(), {.gap = 0.08, .clearance = 0.002})) continue;
    Rng rng = Rng::Stream(seed, "detour");
    const PickPlanResult result = PlanPick(planning, RequestFor(lower), rng);
    ASSERT_TRUE(result.plan) << result.failure;
    detours += result.plan->approach.size() > 2;
    ExpectFree(planning, result.plan->approach);
  }
  EXPECT_GE(detours, 1);
}

TEST(PlanPick, SameStreamSamePlan) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("mug"));
  PlanningScene planning = pick.planning();
  Rng a = Rng::Stream(1, "plan"), b = Rng::Stream(1, "plan");
  const auto first = PlanPick(planning, RequestFor(pick), a).plan;
  const auto second = PlanPick(planning, RequestFor(pick), b).plan;
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->approach, second->approach);
  EXPECT_EQ(first->motion.up, second->motion.up);
}

TEST(PlanPick, DoesNotRetryAFailedGraspWithSwappedFingers) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = pick.planning();
  const Pose world_in_object = pick.scene.body_pose(pick.target_body).inverse();
  const Eigen::Vector3d closing = pick.shape()->grasp_in_tcp().rotation().col(1);
  PickPlanRequest request = RequestFor(pick);
  Rng rng = Rng::Stream(1, "avoid");
  for (int i = 0; i < 3; ++i) {
    const PickPlanResult result = PlanPick(planning, request, rng);
    ASSERT_TRUE(result.plan) << i << ": " << result.failure;
    const Pose grasp = world_in_object * result.plan->motion.grasp.tcp_in_world;
    for (const Pose& failed : request.avoid) {
      const bool near = (grasp.translation() - failed.translation()).norm() < 0.005;
      const double turn = std::abs((grasp.rotation() * closing).dot(failed.rotation() * closing));
      EXPECT_FALSE(near && turn > 0.98);
    }
    request.avoid.push_back(grasp);
  }
}

TEST(PlanPick, ExplainsWhyNoPlanExists) {
  Rng rng = Rng::Stream(1, "why");
  const PickScene far = MakePickScene(ObjectOnTheTable("box"), "demo.yaml", 1.2);
  PlanningScene far_planning = far.planning();
  EXPECT_EQ(PlanPick(far_planning, RequestFor(far), rng).failure, "no grasp in reach");

  // A flat slab has its thickness to hold, and the table in the way; a large cube has nothing.
  SceneObject slab = ObjectOnTheTable("box");
  slab.size = Vec3{0.06, 0.06, 0.02};
  const PickScene flat = MakePickScene(slab);
  PlanningScene flat_planning = flat.planning();
  EXPECT_EQ(PlanPick(flat_planning, RequestFor(flat), rng).failure, "no grasp in reach");
  slab.size = Vec3{0.06, 0.06, 0.06};
  (*slab.pos)[2] = 0.4505 + 0.06;
  const PickScene wide = MakePickScene(slab);
  PlanningScene wide_planning = wide.planning();
  EXPECT_EQ(PlanPick(wide_planning, RequestFor(wide), rng).failure, "no grasp on the object");
}

}  // namespace
}  // namespace robocell
