// PickAndPlaceTask: pick an object up and put it down at a goal: a place in the root frame, or one
// on another object wherever that is, by default in the middle on top of it. Without a goal the task
// draws a goal object of one of the kinds in `goals`, as it draws its objects (object_task.h); in
// the middle of it the robot can put the target down. Success: the object was lifted, held only by
// robots, and is now at rest at the goal with no robot touching it. The reward, 0 to 1, gives a
// quarter for a TCP near the object, a quarter for having lifted it, and half, once it was lifted,
// for its nearness to the goal; at success it is 1. The goal is observed as `goal`, x y z in the
// shared base frame.
//
// The lift is checked after each step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/task/object_task.h"
#include "robocell/task/pick_task_config.h"

namespace robocell {

class PickAndPlaceTask final : public ObjectTask {
 public:
  // Returns the kinds of objects that are drawn as goals: those that the task names, else a tray.
  static std::vector<std::string> GoalKindsOf(const PickAndPlaceTaskConfig& task);
  // Returns the kinds that a task may name: the catalogue and the built-in equipment.
  static std::vector<std::string> AllGoalKinds();
  // Returns a movable object of one of these kinds, without a pose. Throws NotFoundError that lists
  // the kinds.
  static SceneObject MakeGoalObject(const std::string& kind, const std::string& name, Rng& rng);

  explicit PickAndPlaceTask(const PickAndPlaceTaskConfig& fields);

  void Prepare(SceneSpec& spec, Rng& rng) override;
  // Throws ArgumentError without a goal that was named or drawn, or if goal_spread would move an
  // object that cannot move.
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  // Throws ArgumentError if no start is as far from the goal as goal_distance requires.
  BodyPoses Starts(Rng& rng) override;
  // Includes the goal object if each episode places it.
  std::vector<std::string> resting_objects() const override;
  // With a named goal, checks that the object can come to rest there and that a robot can bring it
  // there. In environments this is done once for all objects that may be the target, and throws
  // ArgumentError; in runs a start is refused whose drawn object does not fit the goal.
  // Also refuses a place of the goal whose support differs from that of task.goal, so that another
  // one is drawn.
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override;
  // Also refuses a target that lies nearer to its goal than goal_distance.
  std::optional<Refusal> CheckStart(const Scene& scene) override;
  void Begin(const Scene& scene) override;
  std::string instruction() const override;
  std::string why_not_done() const override { return "not put down at the goal"; }
  std::vector<Feature> signals() const override;
  void Observe(const Scene& scene, std::span<double> out) const override;
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;
  std::string WhyNotRecalled(std::span<const double> memory) const override;
  // Returns where the object's root is to rest. The scene is the one that Begin saw, then or later.
  Eigen::Vector3d GoalInWorld() const;
  // Returns the height above the goal, m, at which the object comes to rest as it lies now: at
  // most goal_tolerance. 0 for a goal on an object, and for one that is not inside its support.
  double RiseOverGoal(const Scene& scene) const;
  // Returns why one of the task's objects cannot come to rest at any of the goals; "" if all can.
  std::string WhyNoRest(const Scene& scene, const std::string& object) const;
  // Returns `picks` (ObjectTask::PossibleContents), each with a goal object, of all kinds in turn.
  static std::vector<StartContents> WithGoals(const std::vector<StartContents>& picks,
                                              const std::vector<std::string>& goals);

 protected:
  // Refuses a target that cannot be put down at the goal as it was grasped.
  std::optional<Refusal> RefuseGrasp(const Scene& scene, PlanningScene& planning,
                                     const GraspMotion& motion) override;

 private:
  bool IsDone(const Scene& scene) override;
  double Progress() const override;
  // Returns true if the task draws a goal object: it names no goal.
  bool draws_goal() const { return draws_goal_; }
  // Returns true if the task draws neither the object nor the goal.
  bool is_named() const { return !draws_objects() && !draws_goal(); }
  void FindGoals(const Scene& scene, const TaskSetting& setting);
  void ChooseGoal(size_t candidate);
  bool has_goal_object() const { return !task_.goal_object.empty(); }
  Eigen::Vector3d TopOfGoalObject(const Scene& scene) const;
  double HeightOfRoot(const Scene& scene) const;
  // Heights over the support under a goal: of the object's root at rest, and of the goal.
  struct GoalInside {
    double root = 0, goal = 0;
  };
  std::optional<GoalInside> InsideAtGoal(const Scene& scene) const;
  std::string WhyTooLow(const Scene& scene) const;
  std::string GoalText() const;
  std::string WhyGoalOutOfReach(const Scene& scene) const;
  std::optional<Refusal> CheckPossible(const Scene& scene);
  std::optional<Refusal> CheckDrawnGoal(const Scene& scene) const;
  std::vector<Eigen::Vector3d> PossibleGoals() const;
  bool IsPutDown(const Scene& scene) const;
  bool IsAtRest(const Scene& scene) const;

  struct GoalCandidate {
    std::string name, kind;
    BodyHandle body;
  };

  PickAndPlaceTaskConfig task_;
  bool draws_goal_;
  std::vector<GoalCandidate> goals_;  // none if the scene has one goal
  size_t chosen_goal_ = 0;            // among goals_
  std::string goal_word_;
  std::optional<BodyHandle> goal_body_;  // body of goal_object
  Pose goal_offset_;                     // its place, or that of the goal, in the root frame
  // The goal in the root frame, or with goal_object in that object's frame.
  Eigen::Vector3d goal_ = Eigen::Vector3d::Zero();
  bool was_lifted_ = false;
  bool is_possible_ = false;  // result of the feasibility check
};

}  // namespace robocell
