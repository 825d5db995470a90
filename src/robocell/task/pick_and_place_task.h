// PickAndPlaceTask: pick an object up and put it down at a goal: a place in the root frame, or one
// on another object, wherever that is; in the middle on top of it unless told otherwise. Success: it was lifted, held only by robots, and is now at
// rest at the goal with no robot touching it. The reward, 0 to 1, has a quarter for a TCP near the
// object, a quarter for having lifted it, and half, once it was lifted, for its nearness to the
// goal; at success it is 1. The goal is observed as `goal`, x y z in the shared base frame.
//
// Whether it was lifted is looked at after each step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/pick_task_config.h"
#include "robocell/task/object_task.h"

namespace robocell {

class PickAndPlaceTask final : public ObjectTask {
 public:
  // As an environment asks for it.
  explicit PickAndPlaceTask(const PickAndPlaceTaskConfig& fields);
  // As a run asks for it. `object`, `goal_object`: names in the scene; `kind`, `goal_kind`: what to
  // call them in the instruction; `all_objects`: whose poses are observed.
  struct Objects {
    std::string object, kind, goal_object, goal_kind;
    std::vector<std::string> all;
  };
  PickAndPlaceTask(const PickAndPlaceTaskConfig& fields, Objects objects);

  // ArgumentError when goal_spread is to move an object that cannot move, and without a goal.
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  // ArgumentError when no start is as far from the goal as goal_distance asks for.
  BodyPoses Starts(Rng& rng) override;
  // The goal object, too, where it is put anew.
  std::vector<std::string> resting_objects() const override;
  // ArgumentError when the object can come to rest at no goal of this task, or no robot can bring it
  // there: looked at once, with the first start. Refuses a goal that was drawn beside its place
  // where something else is under it, for another to be drawn.
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override;
  void Begin(const Scene& scene) override;
  std::string instruction() const override;
  std::vector<std::string> objects() const override { return all_objects_; }
  std::string why_not_done() const override { return "not put down at the goal"; }
  std::vector<Feature> signals() const override;
  void Observe(const Scene& scene, std::span<double> out) const override;
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;
  // Where the object's root is to rest. The scene is where Begin saw it, or later.
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
  // In the root frame, or with goal_object in that object's frame.
  Eigen::Vector3d goal_ = Eigen::Vector3d::Zero();
  bool was_lifted_ = false;
  bool is_possible_ = false;  // as far as it was looked at
};

}  // namespace robocell
