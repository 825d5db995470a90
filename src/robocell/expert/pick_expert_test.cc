#include "robocell/expert/pick_expert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "robocell/scene/scene.h"
#include "robocell/task/grasp_motion.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

// Returns the problem reported for a lift from a range of the base, for the robot of the demo.
std::string LiftProblem(const BaseRange& base, double lift_height) {
  static const PickScene kScene = MakePickScene(ObjectOnTheTable("box"));
  Problems problems;
  ValidateLift(lift_height, base, kScene.robot, problems);
  if (problems.empty()) return "";
  EXPECT_EQ(problems.list().size(), 1u);
  return problems.list()[0].path + ": " + problems.list()[0].message;
}

TEST(ValidateLift, RejectsALiftAboveTheArmAndPrintsTheHighestOne) {
  const BaseRange base{.distance = {0.3, 0.5}, .height_offset = -0.25};
  EXPECT_EQ(LiftProblem(base, 0.05), "");
  const std::string problem = LiftProblem(base, 3);
  EXPECT_THAT(problem, HasSubstr("task.lift_height: 3 m is more than the arm can lift"));
  const std::string give = "give at most ";
  const size_t at = problem.find(give);
  ASSERT_NE(at, std::string::npos) << problem;
  const double most = std::stod(problem.substr(at + give.size()));
  EXPECT_EQ(LiftProblem(base, most), "") << "the printed value is accepted";
  EXPECT_NE(LiftProblem(base, most + 0.002), "");
}

// The geometry is the second way: a TCP at the printed height, above an object at the nearest
// distance, is as far from the base frame as the arm is long.
TEST(ValidateLift, TheHighestLiftIsWhereTheStretchedArmEnds) {
  const BaseRange base{.distance = {0.3, 0.5}, .height_offset = -0.25};
  const std::string problem = LiftProblem(base, 3);
  const std::string give = "give at most ";
  const double most = std::stod(problem.substr(problem.find(give) + give.size()));
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  const Pose up = scene.robot.base().pose().inverse() * scene.robot.base_in_world();
  const double height = GraspMotionsToLift(most).lift - (base.height_offset + up.translation().z());
  const double away = base.distance[0] - up.translation().head<2>().norm();
  EXPECT_NEAR(std::hypot(height, away), scene.robot.reach(), 0.002);
}

TEST(PickExpert, NamesWhatARobotLacks) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  EXPECT_THAT(WhyNot(scene.robot, "pick"), ::testing::IsEmpty());
  EXPECT_THAT(WhyNot(scene.robot, "pick_and_place"), ::testing::IsEmpty());
  SceneSpec spec{.name = "fixed", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  RobotConfig config = ExampleRun("demo.yaml").robot.config;
  config.base = {.kind = BaseKind::kFixed};
  spec.robots.push_back({.name = "rc7", .config = config, .control_modes = config.used_modes()});
  const Scene built = Scene::Build(spec);
  EXPECT_THAT(WhyNot(Robot::Of(built, "rc7"), "pick"),
              ::testing::ElementsAre(HasSubstr("a fixed base cannot be moved. Set `base: {kind: "
                                               "mocap}`")));
}

}  // namespace
}  // namespace robocell::internal
