// PickAndPlaceTask: pick an object up and put it down at a goal: a place in the root frame, or one
// on another object, wherever that is. Success: it was lifted, held only by robots, and is now at
// rest at the goal with no robot touching it. The reward, 0 to 1, has a quarter for a TCP near the
// object, a quarter for having lifted it, and half, once it was lifted, for its nearness to the
// goal; at success it is 1. The goal is observed as `goal`, x y z in the shared base frame.
//
// Whether it was lifted is looked at after each step.
#pragma once

#include <optional>

#include "robocell/spec/pick_task_config.h"
#include "robocell/task/object_task.h"

namespace robocell {

class PickAndPlaceTask final : public ObjectTask {
 public:
  explicit PickAndPlaceTask(const PickAndPlaceTaskConfig& fields);

  // ArgumentError when goal_spread is to move an object that cannot move, and without a goal.
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  // ArgumentError when no start is as far from the goal as goal_distance asks for.
  BodyPoses Starts(Rng& rng) override;
  void Begin(const Scene& scene) override;
  std::string instruction() const override;
  std::vector<std::string> objects() const override;
  std::string why_not_done() const override { return "not put down at the goal"; }
  std::vector<TaskSignal> signals() const override;
  void Observe(const Scene& scene, std::span<double> out) const override;
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;

 private:
  bool IsDone(const Scene& scene) override;
  double Progress() const override;
  bool has_goal_object() const { return !task_.goal_object.empty(); }
  Eigen::Vector3d GoalInWorld() const;
  bool IsPutDown(const Scene& scene) const;

  bool IsAtRest(const Scene& scene) const;

  PickAndPlaceTaskConfig task_;
  std::optional<BodyHandle> goal_body_;  // of goal_object
  Pose goal_offset_;                     // its place, or that of the goal, in the root frame
  Eigen::Vector3d goal_ = Eigen::Vector3d::Zero();  // in the root frame, without goal_object
  bool was_lifted_ = false;
};

}  // namespace robocell
