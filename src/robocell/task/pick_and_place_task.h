// PickAndPlaceTask: pick an object up and put it down at a goal: a place in the root frame, or one
// on another object wherever that is, by default in the middle on top of it. Success: the object
// was lifted, held only by robots, and is now at rest at the goal with no robot touching it. The
// reward, 0 to 1, gives a quarter for a TCP near the object, a quarter for having lifted it, and
// half, once it was lifted, for its nearness to the goal; at success it is 1. The goal is observed
// as `goal`, x y z in the shared base frame.
//
// The lift is checked after each step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/pick_task_config.h"
#include "robocell/task/object_task.h"

namespace robocell {

class PickAndPlaceTask final : public ObjectTask {
 public:
  // Makes the task of an environment.
  explicit PickAndPlaceTask(const PickAndPlaceTaskConfig& fields);
  // The objects of a run's task. `object`, `goal_object`: names in the scene; `kind`, `goal_kind`:
  // their words in the instruction; `all_objects`: objects whose poses are observed.
  struct Objects {
    std::string object, kind, goal_object, goal_kind;
    std::vector<std::string> all;
  };
  PickAndPlaceTask(const PickAndPlaceTaskConfig& fields, Objects objects);

  // Throws ArgumentError without a goal, or if goal_spread would move an object that cannot move.
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  // Throws ArgumentError if no start is as far from the goal as goal_distance requires.
  BodyPoses Starts(Rng& rng) override;
  // Includes the goal object if each episode places it.
  std::vector<std::string> resting_objects() const override;
  // Throws ArgumentError if the object can come to rest at no goal of this task, or if no robot can
  // bring it there; this is checked once, with the first start. Refuses a drawn goal whose support
  // differs from that of its place, so that another one is drawn.
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override;
  void Begin(const Scene& scene) override;
  std::string instruction() const override;
  std::vector<std::string> objects() const override { return all_objects_; }
  std::string why_not_done() const override { return "not put down at the goal"; }
  std::vector<Feature> signals() const override;
  void Observe(const Scene& scene, std::span<double> out) const override;
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;
  // Returns where the object's root is to rest. The scene is the one that Begin saw, then or later.
  Eigen::Vector3d GoalInWorld() const;

 private:
  bool IsDone(const Scene& scene) override;
  double Progress() const override;
  bool has_goal_object() const { return !task_.goal_object.empty(); }
  Eigen::Vector3d TopOfGoalObject(const Scene& scene) const;
  void RequirePossible(const Scene& scene);
  std::optional<Refusal> CheckDrawnGoal(const Scene& scene) const;
  std::vector<Eigen::Vector3d> PossibleGoals() const;
  bool IsPutDown(const Scene& scene) const;
  bool IsAtRest(const Scene& scene) const;

  PickAndPlaceTaskConfig task_;
  std::string goal_word_;
  std::vector<std::string> all_objects_;
  std::optional<BodyHandle> goal_body_;  // of goal_object
  Pose goal_offset_;                     // its place, or that of the goal, in the root frame
  // The goal in the root frame, or with goal_object in that object's frame.
  Eigen::Vector3d goal_ = Eigen::Vector3d::Zero();
  bool was_lifted_ = false;
  bool is_possible_ = false;  // as far as checked
};

}  // namespace robocell
