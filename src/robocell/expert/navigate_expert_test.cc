#include "robocell/expert/navigate_expert.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/motion/clearance.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/task/navigate_kind.h"
#include "robocell/task/testing/driving_runs.h"

namespace robocell {
namespace {

// A robot of random size without an arm.
RobotConfig RandomCart(ModelFolder& folder, Rng& rng) {
  const std::string half_x = std::to_string(rng.Uniform(0.1, 0.35));
  const std::string half_y = std::to_string(rng.Uniform(0.1, 0.3));
  RobotConfig config;
  config.name = "cart";
  config.model = folder.Write(
      "cart",
      "<worldbody><body name=\"hull\"><joint name=\"x\" type=\"slide\" axis=\"1 0 0\"/>"
      "<joint name=\"y\" type=\"slide\" axis=\"0 1 0\"/><joint name=\"turn\" axis=\"0 0 1\"/>"
      "<geom type=\"box\" size=\"" +
          half_x + " " + half_y +
          " 0.2\" pos=\"0 0 0.23\" mass=\"20\"/></body></worldbody><actuator>"
          "<position name=\"dx\" joint=\"x\" kp=\"8000\" kv=\"1200\"/>"
          "<position name=\"dy\" joint=\"y\" kp=\"8000\" kv=\"1200\"/>"
          "<position name=\"dt\" joint=\"turn\" kp=\"800\" kv=\"80\"/></actuator>");
  config.root_body = "hull";
  config.base.kind = BaseKind::kPlanar;
  config.move_groups["wheels"] = {.kind = MoveGroupKind::kBase, .actuators = {"dx", "dy", "dt"}};
  return config;
}

struct Drive {
  bool success = false;
  std::string failure;
  std::vector<std::string> phases;
  double length = 0, nearest = 1, fastest = 0;
};

// Drives from a start that `seed` draws. `before`: called before the first action.
Drive RollOut(const RunConfig& run, int seed, bool blocked = false) {
  internal::FloorStartSampler sampler(run);
  for (int attempt = 0; attempt < 20; ++attempt) {
    Rng rng = Rng::Stream(seed, "drive", attempt);
    SampleResult sample = sampler.Sample({.episode = seed, .attempt = attempt}, rng);
    if (!sample.start) continue;
    Scene scene = sample.start->scene;
    Robot robot = Robot::Of(scene, run.robot.config.name);
    Task& task = *sample.start->task;
    task.Begin(scene);
    EXPECT_FALSE(task.Judge(scene).success);
    const std::shared_ptr<Expert> expert = FindExpertKind("navigate")->Make(run, *sample.start);
    expert->Begin(scene, rng);
    Drive drive;
    Eigen::Vector3d last = robot.base().pose().translation();
    for (int row = 0; row < 600 && !expert->done(); ++row) {
      Action action = expert->Act(scene, rng);
      const std::string phase = expert->phase_names()[static_cast<size_t>(expert->phase())];
      if (drive.phases.empty() || drive.phases.back() != phase) drive.phases.push_back(phase);
      if (!blocked && action.contains(robot.name())) {
        EXPECT_TRUE(robot.Apply(action.at(robot.name())).ok);
      }
      for (int i = 0; i < 33; ++i) {
        robot.Update();
        EXPECT_TRUE(scene.Step().ok());
      }
      scene.SyncPoses();
      const Eigen::Vector3d at = robot.base().pose().translation();
      drive.length += (at - last).norm();
      drive.fastest = std::max(drive.fastest, (at - last).norm() / 0.066);
      last = at;
      if (row % 4 == 0)
        drive.nearest = std::min(drive.nearest, internal::RobotClearance(scene, robot, 1).distance);
    }
    const TaskVerdict verdict = task.Judge(scene);
    drive.success = verdict.success;
    EXPECT_EQ(verdict.success, verdict.progress == 1);
    drive.failure = expert->failure();
    return drive;
  }
  ADD_FAILURE() << "no start in 20 attempts";
  return {};
}

void ExpectArrival(const RunConfig& run, int seed) {
  const Drive drive = RollOut(run, seed);
  EXPECT_TRUE(drive.success) << seed << ": " << drive.failure;
  EXPECT_EQ(drive.failure, "");
  EXPECT_GT(drive.nearest, 0.01) << seed;
  EXPECT_LT(drive.fastest, 1.1 * 0.6) << seed;
  EXPECT_GE(drive.length, 0.9);
  ASSERT_FALSE(drive.phases.empty());
  EXPECT_TRUE(std::ranges::find(drive.phases, "drive") != drive.phases.end());
}

TEST(NavigateExpert, DrivesTheMobileManipulatorToTheTableWithoutTouchingAnything) {
  ExpectArrival(DrivesToTheTable(), 1);
}

TEST(NavigateExpert, DrivesADifferentialDrive) {
  RunConfig run = DrivesToTheTable();
  run.robot = {.file = "", .config = RobotConfig::Load(assets::BuiltinRobotFile("cart"))};
  ExpectArrival(run, 2);
}

TEST(NavigateExpert, DrivesRobotsOfAnySize) {
  for (const int seed : {1, 2}) {
    ModelFolder folder;
    Rng rng = Rng::Stream(seed, "cart");
    RunConfig run = DrivesToTheTable();
    run.robot = {.file = "", .config = RandomCart(folder, rng)};
    ExpectArrival(run, seed);
  }
}

TEST(NavigateExpert, ReportsABaseThatDoesNotFollow) {
  const Drive drive = RollOut(DrivesToTheTable(), 1, true);
  EXPECT_FALSE(drive.success);
  EXPECT_EQ(drive.failure, "the base is blocked");
}

}  // namespace
}  // namespace robocell
