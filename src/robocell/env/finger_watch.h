// FingerWatch: detects that a gripper has come to rest: over windows of time neither a joint that
// moves its fingers nor the opening changes. Private to env.
//
//   FingerWatch watch(robot_with_gripper);
//   watch.Begin(scene.time());                        // commanded something new
//   if (watch.IsStill(scene.time(), opening)) ...     // after every engine step
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "robocell/env/env_state.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {

class FingerWatch {
 public:
  explicit FingerWatch(Robot robot);

  // Restarts from the present state.
  void Begin(double time);
  // Returns true if the fingers are at rest at simulated `time`, with the gripper sent to
  // `opening`. Fingers at that opening, or on an object that they hold, are at rest once they were
  // still for one window; fingers elsewhere may yet begin to move, and are watched for longer. No
  // allocation.
  bool IsStill(double time, double opening);
  // Returns true if the fingers are at an opening, or hold an object. No allocation.
  bool IsWhereItEnds(double opening) const;

  const FingerMemory& memory() const { return memory_; }
  void Recall(FingerMemory memory) { memory_ = std::move(memory); }

 private:
  struct FingerJoint {
    int id;
    double scale;  // its approximate travel between closed and open, rad or m
  };

  const GripperGroup& gripper() const { return robot_.gripper(); }
  // Finds the joints, if the model is another one than last time.
  void Bind();
  // Writes the joints as shares of their travel, and the opening last.
  void Look(std::span<double> out) const;
  double Moved();

  Robot robot_;
  uint64_t generation_ = 0;  // of the model that the joints are in; no scene has 0
  std::vector<FingerJoint> joints_;
  std::vector<double> now_;  // scratch
  FingerMemory memory_;
};

}  // namespace robocell::internal
