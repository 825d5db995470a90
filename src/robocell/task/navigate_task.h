// NavigateTask: a robot with a planar base drives to an object or into a room. Success: its base is
// within `within` of the object and faces it, or stands in the room, at rest. Progress is the share of
// the way, as the crow flies, from the start.
//
// Each start draws where the robot stands (navigate_kind.h), and, without `to`, where it goes.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/motion/floor_map.h"
#include "robocell/robot/robot.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/navigate_task_config.h"
#include "robocell/task/task.h"

namespace robocell::internal {

class NavigateTask : public Task {
 public:
  static constexpr const char* kNoWay = "no way leads there";
  static constexpr const char* kTooNear = "the way is too short";

  explicit NavigateTask(const NavigateTaskConfig& fields) : fields_(fields) {}

  void Prepare(SceneSpec& spec, Rng& rng) override;
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  // Draws where the robot goes.
  BodyPoses Starts(Rng& rng) override;
  // Opens the doors.
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override;
  // Refuses a start from which no way leads there, or a way shorter than `least_way`.
  std::optional<Refusal> CheckStart(const Scene& scene) override;
  void Begin(const Scene& scene) override;
  TaskVerdict Judge(const Scene& scene) override;
  std::string instruction() const override { return "go to the " + word_; }
  std::vector<std::string> subtasks() const override { return {"drive there", "face it and stop"}; }
  std::string why_not_done() const override { return "not there"; }
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;
  std::string WhyNotRecalled(std::span<const double> memory) const override;

  // Returns the way of the base to where the task is done; unset if there is none.
  std::optional<std::vector<FloorPlace>> FindWay(const Robot& robot) const;
  const NavigateTaskConfig& fields() const { return fields_; }

 private:
  struct Destination {
    std::string word;
    // One of them is enough. Of an object: the one that it is in, if that is known.
    std::vector<Room> rooms;
    std::string body;  // "" for a room
  };
  void FindDestinations(const Scene& scene);
  const Destination& destination() const;
  void Choose(size_t number);
  double Distance(const Scene& scene, const Robot& robot) const;
  // Returns true near the object, or in the room.
  bool IsNear(const Scene& scene, const Robot& robot) const;
  bool IsThere(const Scene& scene, const Robot& robot) const;

  NavigateTaskConfig fields_;
  std::string place_ = "task", word_;
  const SceneAnnotations* known_ = nullptr;
  std::vector<Destination> destinations_;
  size_t chosen_ = 0;
  std::vector<Robot> robots_;
  double first_distance_ = 0;
};

}  // namespace robocell::internal
