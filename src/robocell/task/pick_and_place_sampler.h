// PickAndPlaceSampler: starts of pick_and_place tasks in runs. It extends the starts of a pick
// (pick_sampler.h) by a goal object of one of the kinds in `goals`, in the middle of which the
// robot can put the target down.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/task/pick_and_place_task.h"
#include "robocell/task/pick_sampler.h"

namespace robocell::internal {

// Returns the kinds of objects that a run uses as goals: those that it names, else a tray.
std::vector<std::string> GoalKindsOf(const PickAndPlaceTaskConfig& task);
// Returns the kinds that a run may name: the catalogue and the built-in equipment.
std::vector<std::string> AllGoalKinds();
// Returns a movable object of one of these kinds, without a pose. Throws NotFoundError that lists
// the kinds.
SceneObject MakeGoalObject(const std::string& kind, const std::string& name, Rng& rng);

class PickAndPlaceSampler final : public PickTaskSampler {
 public:
  // Throws SpecError for a run of another task.
  explicit PickAndPlaceSampler(const RunConfig& run);

  StartContents AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng) override;
  std::optional<Refusal> ValidateBasePose(Scene& scene, Robot& robot,
                                          const std::string& target_body) override;
  std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                 const std::vector<std::string>& objects) override;

 protected:
  // Refuses a target that cannot be put down at the goal as it was grasped.
  std::optional<Refusal> ValidateGrasp(const Scene& scene, PlanningScene& planning,
                                       const GraspMotion& motion) override;
  bool MayHaveObject(const std::string& name) const override;
  // Also each kind of goal.
  std::vector<StartContents> PossibleContents(int scene_index) override;

 private:
  PickAndPlaceTaskConfig task_;
  std::string goal_kind_;                        // of the start under construction ...
  std::shared_ptr<PickAndPlaceTask> made_task_;  // ... and its task
};

}  // namespace robocell::internal
