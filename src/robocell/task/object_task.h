// ObjectTask: the common part of tasks about one object: where it is put, how high it was lifted,
// who holds it.
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

// The fields of a task that describe its object.
struct ObjectOfTask {
  std::string name = {};   // in the scene
  std::string word = {};   // its name in the instruction; `name` unless set
  double lift_height = 0;  // metres
  Vec2 spread = {0, 0};    // of its place, metres
  bool rotate = false;     // about the vertical at its place
};

class ObjectTask : public Task {
 public:
  explicit ObjectTask(ObjectOfTask object) : fields_(std::move(object)) {}

  // Throws ArgumentError if the object cannot move and NotFoundError if it does not exist. Begin
  // binds an unbound task with all robots of the scene.
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  // Refuses starts that no robot can reach.
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override;
  void Begin(const Scene& scene) override;
  // Returns the reward 1 at success, else the largest progress so far.
  TaskVerdict Judge(const Scene& scene) override;
  std::vector<std::string> objects() const override { return {fields_.name}; }
  std::vector<std::string> resting_objects() const override { return {fields_.name}; }
  // Returns the position where the episode began.
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;

 protected:
  virtual bool IsDone(const Scene& scene) = 0;
  // Returns the progress of a state without success, less than 1.
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
  // Returns a start pose for the object in the root frame.
  Pose Start(Rng& rng) const;

  // Returns 1 with a TCP at the object; falls with the distance.
  double Nearness() const;
  // Returns the height above the start of the episode along the world's z, m.
  double Lift() const;
  // Returns the share of lift_height, 0 to 1.
  double Lifted() const;
  // Returns true if the object is lifted far enough and held (task/held.h).
  bool IsLifted(const Scene& scene) const;

 private:
  ObjectOfTask fields_;
  std::string place_ = "task";
  Pose root_, offset_;
  std::optional<BodyHandle> object_;
  std::vector<Robot> robots_;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();  // in the root frame
};

// Returns 1 at distance 0 (m), falling to 0 far away.
double Near(double distance);

}  // namespace robocell
