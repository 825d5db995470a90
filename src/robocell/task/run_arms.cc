#include "robocell/task/run_arms.h"

#include <algorithm>
#include <optional>

#include "robocell/robot/acting_arms.h"
#include "robocell/robot/robot.h"
#include "robocell/task/pick_task_config.h"

namespace robocell::internal {
namespace {

// Returns "" for a run that names no arm, and for a robot with one arm.
std::string NamedArm(const RunConfig& run) {
  const RobotConfig& robot = run.robot.config;
  const std::optional<PickRun> pick = PickRunOf(run.task);
  const std::string arm = pick ? pick->arm : "";
  if (arm.empty() || arm == kAnyArm || ArmNames(robot).size() < 2) return "";
  return robot.name + "/" + arm;
}

}  // namespace

std::vector<std::string> ArmsWithHands(const Scene& scene, const std::vector<std::string>& robots) {
  std::vector<std::string> all, with_hands;
  for (const std::string& robot : robots) {
    const std::vector<std::string> arms = ActingArms(scene.compiled()->robot(robot).config, robot);
    for (const std::string& name : arms) {
      all.push_back(name);
      if (Robot::Of(scene, name).has_gripper()) with_hands.push_back(name);
    }
  }
  return with_hands.empty() ? all : with_hands;
}

std::vector<std::string> ArmsOfRun(const RunConfig& run, const Scene& scene) {
  if (const std::string named = NamedArm(run); !named.empty()) return {named};
  const std::string& own = run.robot.config.name;
  const auto& robots = scene.compiled()->robots();
  // A scene of another sampler may lack the run's robot; whoever looks it up reports that.
  if (std::ranges::find(robots, own, &RobotRecord::name) == robots.end()) return {own};
  return ArmsWithHands(scene, {own});
}

std::string FirstArmOfRun(const RunConfig& run) {
  const std::string named = NamedArm(run);
  return named.empty() ? run.robot.config.name : named;
}

}  // namespace robocell::internal
