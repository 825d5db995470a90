// PickTask: lift an object off its support. Reward is the height gained (m); success is at least
// `lift_height` above the object's own start while robots hold it.
#pragma once

#include <string>
#include <vector>

#include "robocell/task/task.h"

namespace robocell {

class PickTask : public Task {
 public:
  // `object`: name in the scene; `kind`: what to call it in the instruction.
  PickTask(std::string object, std::string kind, std::vector<std::string> all_objects,
           double lift_height);

  void Begin(const Scene& scene) override;
  double Reward(const Scene& scene) override;
  bool Success(const Scene& scene) override;
  std::string instruction() const override { return "pick up the " + kind_; }
  std::vector<std::string> objects() const override { return all_objects_; }

 private:
  double Lift(const Scene& scene) const;

  std::string object_, kind_;
  std::vector<std::string> all_objects_;
  double lift_height_;
  double start_height_ = 0;
  std::string body_;
};

// Who touches a body's subtree in the present contacts.
struct Touching {
  bool robot = false;
  bool other = false;
};
Touching TouchingBody(const Scene& scene, const std::string& body);
// Whether robots touch it and nothing else does.
bool OnlyRobotsTouch(const Scene& scene, const std::string& body);
// Whether robots hold it: nothing else touches it, and a gripper has it between its fingers
// (GripperGroup::is_grasping) or several robots have it between them. A robot without a gripper
// holds what it touches: whether with a hook or a cup is its own affair. What hangs on one finger
// is not held.
bool IsHeld(const Scene& scene, const std::string& body);

}  // namespace robocell
