// PickAndPlacePlanner: a scripted expert that picks an object up like the PickPlanner and puts it
// down at the goal of a PickAndPlaceTask, for any robot with one arm and one gripper.
//
// Its phases are those of the pick, then transfer (with the object over the goal, collision-free
// for the object too), lower, release, retreat and done. It plans how to put the object down, as
// upright as it stood, once the object is in the hand, and again over the goal if the object moved
// in the hand on the way. An object that slips out of the hand is picked up again, twice at most.
// failure() is one of few texts.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/expert/guided_arm.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/task/pick_and_place_task.h"
#include "robocell/task/place_motion.h"

namespace robocell {

// Returns poses of the object in the world at which it may be let go, best first. The object is
// still where it lies.
using PlacePoses = std::function<std::vector<Pose>(const Scene& scene, Rng& rng)>;

class PickAndPlacePlanner : public Expert {
 public:
  // `task`: the episode's task, after Begin. Names are those in the scene.
  PickAndPlacePlanner(std::string robot, std::string target_object,
                      std::shared_ptr<const PickAndPlaceTask> task, SimOptions sim,
                      const PickPlannerOptions& options = {});
  // Puts the object down at one of these poses.
  PickAndPlacePlanner(std::string robot, std::string target_object, PlacePoses places,
                      SimOptions sim, const PickPlannerOptions& options = {});
  // Makes the planner of a run. Throws SpecError for another task.
  PickAndPlacePlanner(const RunConfig& run, const EpisodeStart& start);
  ~PickAndPlacePlanner() override;

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  int phase() const override;
  std::vector<std::string> phase_names() const override;

 private:
  enum class Phase { kPick, kTransfer, kLower, kRelease, kRetreat, kDone };

  std::string PlanPlace(Rng& rng);
  std::vector<Pose> GoalsFor(const Pose& turned) const;
  std::optional<JointPath> FindTransfer(const JointVector& goal, Rng& rng);
  void Enter(Phase phase);
  void Advance(const Scene& scene, Rng& rng);
  void PickAgain(const Scene& scene, Rng& rng);
  void GiveUp(const std::string& why);
  Action Command() const;
  bool HasMovedInHand() const;
  Pose ObjectInWorld() const;

  std::string robot_name_, target_object_;
  std::shared_ptr<const PickAndPlaceTask> task_;
  PlacePoses places_;  // without a task
  PickPlannerOptions options_;
  PickPlanner pick_;

  std::optional<Robot> robot_;
  std::optional<GuidedArm> arm_;
  std::optional<PlaceMotion> place_;
  JointPath transfer_;
  std::vector<Pose> goals_;  // of places_
  double rise_ = 0;          // PickAndPlaceTask::RiseOverGoal of that pose
  Pose at_rest_;             // the object before it was picked up, in the world
  Pose object_in_tcp_;       // object pose for which the placement was planned
  double opening_ = 0;
  double opening_step_ = 1;  // a tick

  Phase phase_ = Phase::kPick;
  int ticks_ = 0;  // ticks in this phase
  int picks_ = 0, replans_ = 0;
  bool finished_ = false;
  std::string failure_;
};

}  // namespace robocell
