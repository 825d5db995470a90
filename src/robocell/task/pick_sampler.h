// PickTaskSampler: starts of pick tasks in runs: objects of the catalogue lie on the scene's
// support, and the robot can grasp one of them, the target, from where it stands. Kinds of objects
// take turns. pick_and_place_sampler.h adds the goal.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/pick_task_config.h"
#include "robocell/task/grasp_motion.h"
#include "robocell/task/start_sampler.h"

namespace robocell {

class TaskKind;

class PickTaskSampler : public StartSampler {
 public:
  // Throws SpecError for a run of a task that picks nothing up.
  explicit PickTaskSampler(const RunConfig& run);

  StartContents AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng) override;
  // Returns the kinds, the target's first. Kinds take turns over the episodes of a scene and over
  // the scenes, in an order that changes.
  virtual std::vector<std::string> ChooseKinds(const SampleRequest& request, Rng& rng);
  // Also refuses a base from which no grasp of the target is in reach.
  std::optional<Refusal> ValidateBasePose(Scene& scene, Robot& robot,
                                          const std::string& target_body) override;
  std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                 const std::vector<std::string>& objects) override;

 protected:
  const PickRun& pick() const { return pick_; }
  bool MayHaveObject(const std::string& name) const override;
  // Each kind once as the target, with all others beside it.
  std::vector<StartContents> PossibleContents(int scene_index) override;
  // Refuses the start if a grasp in reach is not usable. One of a few grasps in reach has to be
  // usable.
  virtual std::optional<Refusal> ValidateGrasp(const Scene& /*scene*/, PlanningScene& /*planning*/,
                                               const GraspMotion& /*motion*/) {
    return {};
  }

 private:
  std::string KindOfTurn(std::vector<std::string> kinds, const SampleRequest& request) const;
  std::optional<Refusal> ValidateGrasps(const Scene& scene, const Robot& robot,
                                        const std::string& target_body);

  PickRun pick_;
};

// The kinds of tasks `pick` and `pick_and_place`, for the registry of kinds (task_kind.h).
std::shared_ptr<const TaskKind> MakePickKind();
std::shared_ptr<const TaskKind> MakePickAndPlaceKind();

}  // namespace robocell
