#include "robocell/task/grasp_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

std::optional<Refusal> Check(const PickScene& pick, double lift_height = 0.05,
                             const GraspCondition& refuse = {}) {
  return GraspCheck().Check(pick.scene, pick.robot, pick.target_body, lift_height, refuse);
}

TEST(GraspCheck, AcceptsAnObjectThatTheExpertCanPick) {
  EXPECT_FALSE(Check(MakePickScene(ObjectOnTheTable("box"))).has_value());
}

TEST(GraspCheck, RefusesAnObjectOutOfReachAndALiftThatIsTooHigh) {
  const auto far = Check(MakePickScene(ObjectOnTheTable("box"), "demo.yaml", 1.2));
  ASSERT_TRUE(far.has_value());
  EXPECT_EQ(far->reason, Refusal::kNoReachableBasePose);
  EXPECT_THAT(far->detail, ::testing::StartsWith("grasps: "));
  EXPECT_TRUE(Check(MakePickScene(ObjectOnTheTable("box")), 1.2).has_value());
}

TEST(GraspCheck, RefusesAnObjectThatDoesNotFitWithItsSizes) {
  SceneObject block = ObjectOnTheTable("box");
  block.size = Vec3{0.1, 0.1, 0.1};
  block.pos = Vec3{0, 0, 0.5505};
  const auto refusal = Check(MakePickScene(block));
  ASSERT_TRUE(refusal.has_value());
  EXPECT_EQ(refusal->reason, kNoGrasp);
  EXPECT_THAT(refusal->detail, ::testing::HasSubstr("too large, too small or too flat"));
}

TEST(GraspCheck, OneUsableGraspOfAFewIsEnough) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  int calls = 0;
  const auto refuse_but = [&](int good) {
    calls = 0;
    return Check(pick, 0.05, [&, good](PlanningScene&, const GraspMotion&) {
      return ++calls == good ? std::nullopt : std::optional(Refusal{"of no use"});
    });
  };
  EXPECT_FALSE(refuse_but(2).has_value());
  EXPECT_EQ(calls, 2);
  const auto refusal = refuse_but(0);
  ASSERT_TRUE(refusal.has_value());
  EXPECT_EQ(refusal->reason, "of no use");
  EXPECT_LE(calls, 4);
}

}  // namespace
}  // namespace robocell
