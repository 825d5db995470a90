// ObjectTask: what tasks about one object share: where it is put, how high it was lifted, who holds
// it. Private to env.
#pragma once

#include <string>
#include <vector>

#include "robocell/env/env_task.h"
#include "robocell/scene/body_handle.h"

namespace robocell {

class ObjectTask : public EnvTask {
 public:
  // ArgumentError when the object cannot move.
  ObjectTask(const EnvConfig& config, const Scene& scene);

  void Begin(const Scene& scene) override;
  // 1 at success, else as far as it got.
  TaskVerdict Judge(const Scene& scene) final;
  double Reward(const Scene& scene) final { return Judge(scene).reward; }
  std::vector<std::string> objects() const override { return {task_.object}; }
  std::vector<std::string> resting_objects() const override { return {task_.object}; }
  // Where the episode began.
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;

 protected:
  // The reward of a state without success, less than 1.
  virtual double Progress() const = 0;
  const EnvTaskConfig& task() const { return task_; }
  const BodyHandle& object() const { return object_; }
  const Pose& root() const { return root_; }
  std::string place() const { return "environment '" + name_ + "'"; }
  Eigen::Vector3d ObjectInWorld() const { return object_.pose_in_world().translation(); }

  // The place of an object of root_frame_objects, in the root frame, moved by up to `spread`.
  static Pose Around(const Pose& offset, const Vec2& spread, Rng& rng);
  // A place for the object, in the root frame.
  Pose Start(Rng& rng) const;

  // 1 with a TCP at the object, falling with the distance.
  double Nearness() const;
  // Above where the episode began, along the world's z, m.
  double Lift() const;
  // Lifted far enough, and held (task/pick_task.h).
  bool IsLifted(const Scene& scene) const;

 private:
  std::string name_;
  EnvTaskConfig task_;
  Pose root_, offset_;
  BodyHandle object_;
  std::vector<Robot> robots_;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();  // in the root frame
};

// 1 at no distance (m), 0 far away.
double Near(double distance);

}  // namespace robocell
