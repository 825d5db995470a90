// Skills for objects in the hand: put one where a relation holds, and hold one.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/expert/pick_and_place_planner.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/expert/skill.h"

namespace robocell {
namespace {

constexpr int kPlaces = 48;  // poses of the relation that are tried

// A planner as a skill.
template <class Planner>
class PlannerSkill final : public Skill {
 public:
  template <class... Args>
  explicit PlannerSkill(Args&&... args) : planner_(std::forward<Args>(args)...) {}
  void Begin(const Scene& scene, Rng& rng) override { planner_.Begin(scene, rng); }
  Action Act(const Scene& scene, Rng& rng) override { return planner_.Act(scene, rng); }
  bool done() const override { return planner_.done(); }
  std::string failure() const override { return planner_.failure(); }
  std::string phase() const override {
    return planner_.phase_names()[static_cast<size_t>(planner_.phase())];
  }

 private:
  Planner planner_;
};

PickPlannerOptions OptionsOf(const SkillSettings& settings) { return {.tick = settings.tick}; }

}  // namespace

std::unique_ptr<Skill> MakePlaceSkill(const SkillSettings& settings,
                                      const RelationTask::Goal& goal) {
  const PlacePoses places = [bound = goal.bound](const Scene& scene, Rng& rng) {
    scene.SyncPoses();
    return bound->Sample(rng, kPlaces).poses;
  };
  return std::make_unique<PlannerSkill<PickAndPlacePlanner>>(
      settings.robot, goal.stated.subject, places, settings.sim, OptionsOf(settings));
}

std::unique_ptr<Skill> MakeHoldSkill(const SkillSettings& settings,
                                     const RelationTask::Goal& goal) {
  return std::make_unique<PlannerSkill<PickPlanner>>(settings.robot, goal.stated.subject,
                                                     settings.sim, OptionsOf(settings));
}

}  // namespace robocell
