#include "robocell/task/grasp_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

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

// A plate is too wide from above. Its edge could be grasped, where the table or the reach stops it:
// that is the reason, and another place may do.
TEST(GraspCheck, AnObjectThatOnlyItsSidesFitIsNotCalledTooLarge) {
  SceneObject plate = ObjectOnTheTable("box");
  plate.size = Vec3{0.1, 0.1, 0.01};
  plate.pos = Vec3{0, 0, 0.4605};
  for (const double distance : {0.42, 1.4}) {
    const auto refusal = Check(MakePickScene(plate, "demo.yaml", distance));
    ASSERT_TRUE(refusal.has_value());
    EXPECT_NE(refusal->reason, kNoGrasp) << refusal->detail;
    EXPECT_EQ(refusal->detail.find("too large"), std::string::npos) << refusal->detail;
    EXPECT_THAT(refusal->detail, ::testing::StartsWith("grasps: "));
    EXPECT_FALSE(refusal->holds_everywhere);
  }
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
