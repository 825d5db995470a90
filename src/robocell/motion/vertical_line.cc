#include "robocell/motion/vertical_line.h"

#include "robocell/kinematics/ik.h"

namespace robocell::internal {
namespace {

// Largest motion of a joint along the line, rad (m): a solution farther away is on another branch.
constexpr double kMostTurn = 1.2;

}  // namespace

JointPath LineAbove(const Chain& chain, const TaskSpace& task, const Pose& tcp,
                    const JointVector& q, const Eigen::Vector3d& up, double height) {
  JointPath line = {q};
  for (int k = 1; k <= kLinePoints; ++k) {
    const Pose at(tcp.translation() + up * (height * k / kLinePoints), tcp.quaternion());
    IkResult ik =
        Ik(chain, at, {.tolerance = kLineIkTolerance, .seed = line.back(), .max_restarts = 0});
    if (!ik.success) ik = task.SolveWithin(chain, at, line.back(), kMostTilt);
    if (!ik.success || JointDistance(ik.q, q) > kMostTurn) break;
    line.push_back(ik.q);
  }
  return line;
}

double MissingShare(const JointPath& line) {
  return 1 - (static_cast<double>(line.size()) - 1) / kLinePoints;
}

}  // namespace robocell::internal
