// PickAndPlaceSampler: starts of pick_and_place tasks in runs: those of a pick (pick_sampler.h), and
// one of the kinds in `goals` beside the objects, in the middle of which the robot can put the target
// down.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/task/pick_and_place_task.h"
#include "robocell/task/pick_sampler.h"

namespace robocell::internal {

// The kinds of things that a run may put objects on: those it names, else a tray.
std::vector<std::string> GoalKindsOf(const PickAndPlaceTaskConfig& task);
// What may be named: the catalogue, and the built-in equipment.
std::vector<std::string> AllGoalKinds();
// One of them, which can move; no pose. NotFoundError lists the kinds.
SceneObject MakeGoalObject(const std::string& kind, const std::string& name, Rng& rng);

class PickAndPlaceSampler final : public PickTaskSampler {
 public:
  // SpecError for a run of another task.
  explicit PickAndPlaceSampler(const RunConfig& run);

  StartContents AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng) override;
  std::optional<Refusal> ValidateBasePose(Scene& scene, Robot& robot,
                                          const std::string& target_body) override;
  std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                 const std::vector<std::string>& objects) override;

 protected:
  // Whether the target can be put down at the goal as it was grasped.
  std::optional<Refusal> ValidateGrasp(const Scene& scene, PlanningScene& planning,
                                       const GraspMotion& motion) override;
  bool MayHaveObject(const std::string& name) const override;
  // Also each kind of goal.
  std::vector<StartContents> PossibleContents(int scene_index) override;

 private:
  PickAndPlaceTaskConfig task_;
  std::string goal_kind_;                        // of the start that is being made ...
  std::shared_ptr<PickAndPlaceTask> made_task_;  // ... and its task
};

}  // namespace robocell::internal
