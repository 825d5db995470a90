#include "robocell/control/pose_target.h"

#include "robocell/base/error.h"
#include "robocell/robot/controller.h"

namespace robocell {

PoseNumbers ToNumbers(const Pose& pose) {
  const auto& p = pose.translation();
  const auto& q = pose.quaternion();
  return {p[0], p[1], p[2], q[0], q[1], q[2], q[3]};
}

Pose PoseFromNumbers(std::span<const double> n, const MoveGroup& group) {
  RequireValues([&] { return group.place(); }, "pose", n, 7);
  try {
    return Pose({n[0], n[1], n[2]}, Quaternion{n[3], n[4], n[5], n[6]});
  } catch (const ArgumentError& error) {
    throw ArgumentError(group.place() + ": the target pose: " + error.what());
  }
}

}  // namespace robocell
