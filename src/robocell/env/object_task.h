// ObjectTask: what tasks about one object share: where it is put, how high it was lifted, who holds
// it. Private to env.
#pragma once

#include <string>
#include <vector>

#include "robocell/env/env_task.h"

namespace robocell {

class ObjectTask : public EnvTask {
 public:
  // ArgumentError when the object cannot move.
  ObjectTask(const EnvConfig& config, const Scene& scene);

  void Begin(const Scene& scene) override;
  std::vector<std::string> objects() const override { return {task_.object}; }
  // Where the episode began.
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;

 protected:
  const EnvTaskConfig& task() const { return task_; }
  const std::string& body() const { return body_; }
  const Pose& root() const { return root_; }
  std::string place() const { return "environment '" + name_ + "'"; }
  Eigen::Vector3d ObjectInWorld(const Scene& scene) const;

  // The place of an object of root_frame_objects, in the root frame, moved by up to `spread`.
  static Pose Around(const Pose& offset, const Vec2& spread, Rng& rng);
  // A place for the object, in the root frame.
  Pose Start(Rng& rng) const;
  void Put(Scene& scene, const Pose& in_root) const;

  // 1 with a TCP at the object, falling with the distance.
  double Nearness(const Scene& scene) const;
  // Above where the episode began, along the world's z, m.
  double Lift(const Scene& scene) const;
  // Lifted far enough, and held by robots only.
  bool IsLifted(const Scene& scene) const;

 private:
  std::string name_;
  EnvTaskConfig task_;
  Pose root_, offset_;
  std::string body_;
  std::vector<Robot> robots_;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();  // in the root frame
};

// 1 at no distance (m), 0 far away.
double Near(double distance);

}  // namespace robocell
