#include "robocell/expert/any_arm.h"

#include <algorithm>
#include <map>
#include <utility>
#include <Eigen/Core>
#include <mujoco/mujoco.h>
#include <nlohmann/json.hpp>

#include "robocell/robot/robot.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/task/pick_task_config.h"

namespace robocell::internal {

std::vector<std::string> NearestArms(const Scene& scene, std::vector<std::string> arms,
                                     const std::string& object) {
  if (arms.size() < 2) return arms;
  const Eigen::Vector3d at(scene.data()->xpos + 3 * RequireObjectOrBody(scene, object));
  std::map<std::string, double> distances;
  for (const std::string& arm : arms)
    distances[arm] = (Robot::Of(scene, arm).tcp_in_world().translation() - at).norm();
  std::ranges::stable_sort(arms, {}, [&](const std::string& arm) { return distances.at(arm); });
  return arms;
}

RunConfig WithArm(RunConfig run, const std::string& acting) {
  const size_t slash = acting.rfind('/');
  if (slash == std::string::npos) return run;
  const std::string arm = acting.substr(slash + 1);
  if (auto* pick = run.task.If<PickTaskConfig>()) pick->arm = arm;
  if (auto* place = run.task.If<PickAndPlaceTaskConfig>()) place->arm = arm;
  return run;
}

AnyArm::AnyArm(std::vector<Candidate> candidates, std::string object)
    : candidates_(std::move(candidates)), object_(std::move(object)) {}

void AnyArm::Begin(const Scene& scene, Rng& rng) {
  std::vector<std::string> names;
  for (const Candidate& candidate : candidates_) names.push_back(candidate.arm);
  for (const std::string& name : NearestArms(scene, names, object_)) {
    acting_ = static_cast<size_t>(std::ranges::find(names, name) - names.begin());
    acting().Begin(scene, rng);
    if (acting().failure().empty()) return;
  }
}

std::string AnyArm::results_json() const {
  nlohmann::json results = nlohmann::json::parse(acting().results_json());
  const std::string& arm = candidates_[acting_].arm;
  results["arm"] = arm.substr(arm.rfind('/') + 1);
  return results.dump();
}

}  // namespace robocell::internal
