// ObjectTask: what tasks about one object share: where it is put, how high it was lifted, who holds
// it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/body_handle.h"
#include "robocell/spec/types.h"
#include "robocell/task/task.h"

namespace robocell {

// What a task about an object says of it.
struct ObjectOfTask {
  std::string name = {};   // in the scene
  std::string word = {};   // what to call it in the instruction; its name unless set
  double lift_height = 0;  // metres
  Vec2 spread = {0, 0};    // of its place, metres
  bool rotate = false;     // at its place
};

class ObjectTask : public Task {
 public:
  explicit ObjectTask(ObjectOfTask object) : fields_(std::move(object)) {}

  // ArgumentError when the object cannot move; NotFoundError without it. Begin binds a task that is
  // not bound, with all robots of the scene.
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  // Refuses starts that no robot can reach.
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override;
  void Begin(const Scene& scene) override;
  // The reward is 1 at success, else the progress, as far as it got.
  TaskVerdict Judge(const Scene& scene) override;
  std::vector<std::string> objects() const override { return {fields_.name}; }
  std::vector<std::string> resting_objects() const override { return {fields_.name}; }
  // Where the episode began.
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;

 protected:
  virtual bool IsDone(const Scene& scene) = 0;
  // Of a state without success, less than 1.
  virtual double Progress() const = 0;

  const ObjectOfTask& fields() const { return fields_; }
  std::string word() const { return fields_.word.empty() ? fields_.name : fields_.word; }
  const BodyHandle& object() const { return *object_; }
  const Pose& root() const { return root_; }
  const std::string& place() const { return place_; }
  const std::vector<Robot>& robots() const { return robots_; }
  Eigen::Vector3d ObjectInWorld() const { return object_->pose_in_world().translation(); }

  // Moves a place in the root frame by up to `spread`.
  static Pose Around(const Pose& offset, const Vec2& spread, Rng& rng);
  // A place for the object, in the root frame.
  Pose Start(Rng& rng) const;

  // 1 with a TCP at the object, falling with the distance.
  double Nearness() const;
  // Above where the episode began, along the world's z, m.
  double Lift() const;
  // The share of lift_height, 0 to 1.
  double Lifted() const;
  // Lifted far enough, and held (task/held.h).
  bool IsLifted(const Scene& scene) const;

 private:
  ObjectOfTask fields_;
  std::string place_ = "task";
  Pose root_, offset_;
  std::optional<BodyHandle> object_;
  std::vector<Robot> robots_;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();  // in the root frame
};

// 1 at no distance (m), 0 far away.
double Near(double distance);

}  // namespace robocell
