#include "robocell/task/grasp_motion.h"

#include <gtest/gtest.h>

#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

std::vector<GraspCandidate> Candidates(const PlanningScene& planning) {
  return FindGrasps(planning.model(), planning.data(), planning.target_body(), planning.shape(),
                    planning.robot().tcp_in_world());
}

TEST(GraspMotions, MoveStraightDownAndUpAgain) {
  for (const char* kind : {"box", "mug", "bottle"}) {
    const PickScene pick = MakePickScene(ObjectOnTheTable(kind));
    PlanningScene planning = pick.planning();
    GraspMotions motions(planning, Candidates(planning), pick.home(), {.above = 0.08, .lift = 0.1});
    const auto motion = motions.Next();
    ASSERT_TRUE(motion) << kind << ": " << motions.Reasons();
    EXPECT_EQ(motion->down.back(), motion->up.front());
    const Pose base = pick.robot.base_in_world(), grasp = motion->grasp.tcp_in_world;
    const auto height_above = [&](const JointVector& q) {
      const Pose tcp = base * pick.robot.FkFrame(q);
      EXPECT_TRUE(tcp.is_close(
          Pose({grasp.translation().x(), grasp.translation().y(), tcp.translation().z()},
               grasp.quaternion()),
          1e-3, 1e-3));
      return tcp.translation().z() - grasp.translation().z();
    };
    EXPECT_NEAR(height_above(motion->down.front()), 0.08, 1e-3);
    EXPECT_NEAR(height_above(motion->up.back()), 0.1, 1e-3);
    // The path is linear in joint space: half way the hand is still nearly on the line.
    for (const JointPath* line : {&motion->down, &motion->up}) {
      for (size_t i = 1; i < line->size(); ++i) {
        const Pose tcp = base * pick.robot.FkFrame(Blend((*line)[i - 1], (*line)[i], 0.5));
        EXPECT_LT((tcp.translation() - grasp.translation()).head<2>().norm(), 0.003);
      }
    }
  }
}

TEST(GraspMotions, TheLiftNeedsNoSecondPosture) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("nut"));
  PlanningScene planning = pick.planning();
  GraspMotions motions(planning, Candidates(planning), pick.home());
  int count = 0;
  while (const auto motion = motions.Next()) {
    ++count;
    for (const JointVector& q : motion->down) EXPECT_LT(JointDistance(q, motion->down.back()), 1.2);
    for (const JointVector& q : motion->down)
      EXPECT_TRUE(planning.IsFree(q, {.gap = pick.shape()->open_gap()}));
  }
  EXPECT_GT(count, 3);
}

TEST(GraspMotions, CountGraspsOutOfReach) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"), "demo.yaml", 1.2);
  PlanningScene planning = pick.planning();
  std::vector<GraspCandidate> candidates = Candidates(planning);
  candidates.resize(5);
  GraspMotions motions(planning, candidates, pick.home());
  EXPECT_FALSE(motions.Next());
  const std::string reasons = motions.Reasons(),
                    begin = "of 5 grasps 5 out of reach (the nearest by ";
  ASSERT_TRUE(reasons.starts_with(begin)) << reasons;
  // The arm's end comes as near to the nearest grasp as the reported distance says.
  const double far =
      (candidates[0].tcp_in_world.translation() - planning.robot().base_in_world().translation())
          .norm();
  const double missing = std::stod(reasons.substr(begin.size()));
  EXPECT_GT(missing, far - planning.robot().reach() - 0.1) << reasons;
  EXPECT_LT(missing, far) << reasons;
}

TEST(GraspMotions, ReportsALiftOutOfReach) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  PlanningScene planning = pick.planning();
  GraspMotions motions(planning, Candidates(planning), pick.home(), {.lift = 3});
  EXPECT_FALSE(motions.Next());
  const std::string what = " that cannot be lifted by 3.00 m (the last ";
  const std::string reasons = motions.Reasons();
  ASSERT_NE(reasons.find(what), std::string::npos) << reasons;
  const double missing = std::stod(reasons.substr(reasons.find(what) + what.size()));
  EXPECT_GT(missing, 1.4) << "more than half of it";
  EXPECT_LE(missing, 3);
}

// A wall of boxes around the object leaves no space for the fingers.
TEST(GraspMotions, IncludeCollisionsWithOtherObjects) {
  PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  SceneSpec spec = pick.scene.spec();
  for (const double side : {-1.0, 1.0}) {
    for (const bool across : {false, true}) {
      SceneObject wall{.name = "wall" + std::to_string(spec.objects.size()), .shape = Shape::kBox};
      wall.size = across ? Vec3{0.09, 0.02, 0.06} : Vec3{0.02, 0.05, 0.06};
      wall.rgba = Vec4{1, 1, 1, 1};
      wall.mass = 1;
      wall.friction = Vec3{1, 0.01, 0.001};
      wall.pos = across ? Vec3{0, side * 0.07, 0.511} : Vec3{side * 0.07, 0, 0.511};
      spec.objects.push_back(wall);
    }
  }
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "rc7");
  PlanningScene planning(scene, robot, "target", pick.shape());
  GraspMotions motions(planning, Candidates(planning), pick.home());
  EXPECT_FALSE(motions.Next());
  EXPECT_NE(motions.Reasons().find("in collision (most often body 'robot"), std::string::npos)
      << motions.Reasons();
  EXPECT_EQ(motions.Reasons().find(" 0 in collision"), std::string::npos) << motions.Reasons();
}

}  // namespace
}  // namespace robocell
