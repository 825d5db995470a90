// FingerWatch: whether a gripper has come to rest, by what its fingers do: over windows of time
// neither a joint that moves them nor the opening changes. Private to env.
//
//   FingerWatch watch(robot_with_gripper);
//   watch.Begin(scene.time());                        // commanded something new
//   if (watch.IsStill(scene.time(), opening)) ...     // after every engine step
#pragma once

#include <span>
#include <vector>

#include "robocell/robot/robot.h"

namespace robocell {

class FingerWatch {
 public:
  // The state from earlier ticks.
  struct Memory {
    double still_windows = 0;  // one after another, up to now
    bool is_still = false;
    double window_start = 0;
    std::vector<double> window;  // the fingers when it began, see Look
  };

  explicit FingerWatch(Robot robot);

  // Looks anew, from the present state on.
  void Begin(double time);
  // At simulated `time`, with the gripper sent to `opening`. Fingers at rest there, or on something
  // that they hold, rest once they were still for one window; fingers elsewhere may yet begin to
  // move, and are watched for longer. No allocation.
  bool IsStill(double time, double opening);

  const Memory& memory() const { return memory_; }
  void Recall(Memory memory) { memory_ = std::move(memory); }

 private:
  struct FingerJoint {
    int id;
    double scale;  // what it moves between closed and open, roughly, rad or m
  };

  const GripperGroup& gripper() const { return robot_.gripper(); }
  void Bind();
  // Joints as shares of their travel, and the opening last.
  void Look(std::span<double> out) const;
  double Moved();
  bool IsWhereItEnds(double opening) const;

  Robot robot_;
  std::vector<FingerJoint> joints_;
  std::vector<double> now_;  // scratch
  Memory memory_;
};

}  // namespace robocell
