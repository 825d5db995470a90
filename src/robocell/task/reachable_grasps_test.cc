#include "robocell/task/reachable_grasps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/motion/planning_scene.h"
#include "robocell/task/grasp_generator.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

// The oracles are forward kinematics, and the planner's own test of configurations.
TEST(FindReachableGrasps, TheArmGetsThereAndTouchesNothingElse) {
  for (const char* kind : {"bottle", "mug", "box"}) {
    const PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    const GraspSet grasps = GenerateGrasps(pick.robot, "target", {.samples = 500, .most = 60});
    const ReachReport report = FindReachableGrasps(pick.robot, grasps, {.most = 3, .lift = 0.1});
    ASSERT_FALSE(report.found.empty()) << kind << ": " << report.Reasons();
    const MotionPlanner planner(pick.robot,
                                {.clearance = 0, .allowed_contacts = {{pick.target_body, ""}}});
    const Pose body = pick.scene.body_pose(pick.target_body);
    for (const ReachableGrasp& found : report.found) {
      const Grasp& grasp = grasps.grasps[static_cast<size_t>(found.index)];
      EXPECT_TRUE(found.tcp_in_world.is_close(body * grasp.tcp_in_body, 1e-9, 1e-9));
      const Pose at = pick.robot.base_in_world() * pick.robot.FkFrame(found.way.back());
      EXPECT_TRUE(at.is_close(found.tcp_in_world, 1e-3, 1e-3)) << kind;
      const Pose before = pick.robot.base_in_world() * pick.robot.FkFrame(found.way.front());
      EXPECT_TRUE(before.is_close(body * grasp.before(), 1e-3, 1e-3)) << kind;
      for (const JointVector& q : found.way) EXPECT_GE(planner.Clearance(q, 0.01), -1e-4) << kind;
      const Pose up = pick.robot.base_in_world() * pick.robot.FkFrame(found.up.back());
      EXPECT_NEAR(up.translation().z() - at.translation().z(), 0.1, 1e-3);
    }
  }
}

TEST(FindReachableGrasps, SaysWhyThereIsNone) {
  SceneObject far = ObjectOnTheTable("box");
  const PickScene pick = MakePickScene(far, "demo.yaml", 3.0);
  const GraspSet grasps = GenerateGrasps(pick.robot, "target", {.samples = 200, .most = 20});
  const ReachReport report = FindReachableGrasps(pick.robot, grasps);
  EXPECT_TRUE(report.found.empty());
  EXPECT_NE(report.Reasons().find("out of reach"), std::string::npos) << report.Reasons();
}

TEST(FindReachableGrasps, RejectsOptionsAndGraspsThatDoNotFit) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const GraspSet good{.robot = pick.robot.name(), .body = pick.target_body, .grasps = {{}}};
  const auto error_of = [&](const GraspSet& set, const ReachOptions& options = {}) -> std::string {
    try {
      FindReachableGrasps(pick.robot, set, options);
    } catch (const ArgumentError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of(good), "");
  GraspSet bad = good;
  bad.robot = "left";
  EXPECT_THAT(error_of(bad), ::testing::HasSubstr("those of robot 'left'"));
  bad = good;
  bad.grasps[0].opening = -1;
  EXPECT_THAT(error_of(bad), ::testing::HasSubstr("grasps[0] has an opening below 0"));
  bad = good;
  bad.grasps[0].approach.setZero();
  EXPECT_THAT(error_of(bad), ::testing::HasSubstr("approach that is no unit vector"));
  EXPECT_THROW(GoalsBefore(pick.scene, bad), ArgumentError);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of(good, {.most = 0}), ::testing::HasSubstr("most must be at least 1"));
  EXPECT_THAT(error_of(good, {.tried = -1}), ::testing::HasSubstr("tried must be at least 1"));
  EXPECT_THAT(error_of(good, {.clearance = nan}), ::testing::HasSubstr("clearance must be"));
  EXPECT_THAT(error_of(good, {.lift = nan}), ::testing::HasSubstr("lift must be"));
  EXPECT_THAT(error_of(good, {.costs = {.turn = nan}}), ::testing::HasSubstr("costs must be"));
}

TEST(GoalsBefore, ThePlannerReachesOne) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("bottle"));
  const GraspSet grasps = GenerateGrasps(pick.robot, "target", {.samples = 500, .most = 60});
  const std::vector<MotionGoal> goals = GoalsBefore(pick.scene, grasps, 20);
  ASSERT_EQ(goals.size(), std::min<size_t>(20, grasps.grasps.size()));
  const MotionResult result = Plan(pick.robot, goals);
  EXPECT_TRUE(result.success) << result.message;
}

}  // namespace
}  // namespace robocell
