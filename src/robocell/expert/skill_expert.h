// SkillExpert: the scripted expert of all tasks whose goals are relations (task/relation_task.h),
// for any robot with arms and grippers. For each relation that does not hold, in order, it
// uses a skill (skill.h); it repeats what failed or was undone, and gives up with a reason.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/expert/expert.h"
#include "robocell/expert/skill.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell {

class SkillExpert final : public Expert {
 public:
  // `task`: the episode's task, after Begin.
  SkillExpert(SkillSettings settings, std::shared_ptr<const RelationTask> task);
  // Makes the expert of a run. Throws SpecError for a task without relations.
  SkillExpert(const RunConfig& run, const EpisodeStart& start);

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  int phase() const override;
  std::vector<std::string> phase_names() const override { return *phases_; }

 private:
  void Next(const Scene& scene, Rng& rng);
  void ChooseArm(const Scene& scene, const RelationTask::Goal& goal);
  bool PutsDown(const Scene& scene, const RelationTask::Goal& goal);
  void Finish();
  std::unique_ptr<Skill> SkillFor(const RelationTask::Goal& goal) const;

  SkillSettings settings_;
  std::shared_ptr<const RelationTask> task_;
  const std::vector<std::string>* phases_ = &SkillPhases();
  std::unique_ptr<Skill> skill_;
  std::vector<int> tries_, failures_;  // of each goal
  std::vector<int> put_down_;          // failures of each goal after which it set the object down
  bool puts_down_ = false;             // the skill sets an object down
  size_t goal_ = 0;                    // of the skill
  double progress_ = 0;                // of that goal, when the skill began
  Action last_;
  int waited_ = 0;  // ticks since all goals hold
  bool finished_ = false;
  std::string setback_, failure_;
};

}  // namespace robocell
