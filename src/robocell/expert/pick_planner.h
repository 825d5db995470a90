// PickPlanner: a scripted expert that picks up an object from above with any robot that has one arm
// and one gripper. It plans on a scratch copy of the scene and then acts once per policy tick with
// one joint target and one opening.
//
// Phases: open (also backing off after a failure), pregrasp, grasp, close, lift, done (holding at
// the top). It detects an empty hand, an object that slipped, fingers that stopped on something
// else and an arm that does not follow; it then re-opens, backs off and tries the next best grasp,
// at most three times in all. failure() is one of few texts.
//
// Nothing is tuned to a robot: the gripper's properties are measured (gripper_shape.h), and the
// lift is slow enough that the arm's servos stay below their force limits (timed_path.h).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/expert/expert.h"
#include "robocell/expert/guided_arm.h"
#include "robocell/expert/pick_plan.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell {

struct PickPlannerOptions {
  double tick = 0.066;      // seconds between actions
  double above = 0.08;      // height of the pregrasp over the grasp, metres
  double lift = 0.10;       // metres
  double free_speed = 1.2;  // speed of the fastest joint on free paths, rad/s (m/s)
  double line_speed = 0.6;  // ... on the way down and up
  int attempts = 3;         // grasp attempts
  GraspUse usable = {};     // which grasps the task can go on from; unset: all
};

// Returns the options of a run.
PickPlannerOptions PickPlannerOptionsOf(const RunConfig& run);

class PickPlanner : public Expert {
 public:
  static constexpr double kOpened = 0.9;  // opening that counts as open

  // Names are those in the scene. `options` as in GripperShape::Of.
  PickPlanner(std::string robot, std::string target_object, SimOptions sim,
              const PickPlannerOptions& options = {});
  // Makes the planner of a run.
  PickPlanner(const RunConfig& run, const EpisodeStart& start);
  ~PickPlanner() override;

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  int phase() const override { return static_cast<int>(phase_); }
  std::vector<std::string> phase_names() const override;

  // Returns the number of grasps tried so far.
  int attempts() const { return attempts_; }
  // Returns the opening, 0 to 1, at which the hand approaches the object.
  double ApproachOpening() const;
  // Returns true if there is nothing between the fingers, or on the suction cup.
  bool HandIsEmpty() const;
  // Return the planning scene of the last plan, and the width of the held object, metres; for
  // planners that continue after `done` without a failure.
  PlanningScene& planning() { return *planning_; }
  double held_width() const { return plan_->motion.grasp.width; }

 private:
  enum class Phase { kOpen, kPregrasp, kGrasp, kClose, kLift, kDone };

  bool Plan(Rng& rng);
  void Enter(Phase phase);
  void Advance(Rng& rng);
  void LeaveOpen(Rng& rng);
  void Follow(Phase next);
  void CloseFurther();
  void LeaveClose();
  void Watch();
  void Fail(const std::string& why);
  void GiveUp(const std::string& why);
  Action Command() const;
  int Ticks(double seconds) const { return arm_->Ticks(seconds); }
  double Gap() const;
  Pose TargetPose() const;
  double TargetHeight() const { return TargetPose().translation().z(); }

  std::string robot_name_, target_object_;
  SimOptions sim_;
  PickPlannerOptions options_;

  std::optional<Robot> robot_;
  std::shared_ptr<const GripperShape> shape_;
  std::unique_ptr<PlanningScene> planning_;
  std::optional<PickPlan> plan_;
  JointVector home_;
  std::optional<GuidedArm> arm_;
  double opening_ = 1;
  JointVector retreat_;       // configuration to back off to; empty: none
  Pose planned_for_;          // the object's pose at the time of planning, in the world
  std::vector<Pose> failed_;  // grasps, TCP in the object's frame

  Phase phase_ = Phase::kOpen;
  int ticks_ = 0;     // ticks in this phase
  int squeezed_ = 0;  // ticks since the command to close the hand
  int attempts_ = 0;
  double last_gap_ = 0, grasp_height_ = 0;
  bool finished_ = false;
  std::string setback_;  // why the last attempt failed
  std::string failure_;
};

}  // namespace robocell
