#include "robocell/robot/joint_pos_for_ctrl.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <vector>
#include <Eigen/QR>

#include "robocell/mujoco/names.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/drive_matrix.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

bool JointPosForCtrl(const MoveGroup& group, std::span<double> q) {
  if (!group.scene() || q.size() != group.joint_names().size()) return false;
  const mjModel* m = group.scene()->model();
  std::vector<int> joints;
  for (const std::string& joint : group.joint_names())
    joints.push_back(FindId(m, mjOBJ_JOINT, joint));
  if (std::find(joints.begin(), joints.end(), -1) != joints.end()) return false;
  const std::vector<JointFollower> followers = FollowersOf(m, joints);
  std::vector<DriveLength> lengths;
  std::vector<double> wanted;
  for (const std::string& name : group.actuator_names()) {
    const int id = FindId(m, mjOBJ_ACTUATOR, name);
    if (id < 0 || !IsPositionServo(m, id)) return false;
    auto length = LengthOver(m, id, joints, followers);
    if (!length || length->empty()) return false;
    lengths.push_back(std::move(*length));
    const double ctrl = group.scene()->data()->ctrl[m->actuator_ctrladr[id]];
    wanted.push_back(RestingLength(m, id, {.ctrl = ctrl}));
  }
  // Lengths that are sums need one step, those of followers that bend a few.
  constexpr int kSteps = 8;
  std::vector<double> found(q.begin(), q.end());
  for (int step = 0; step < kSteps; ++step) {
    Eigen::VectorXd off(static_cast<Eigen::Index>(lengths.size()));
    for (std::size_t a = 0; a < lengths.size(); ++a)
      off[static_cast<Eigen::Index>(a)] = wanted[a] - LengthAt(lengths[a], found);
    const Eigen::MatrixXd matrix = DriveMatrix(lengths, found);
    const Eigen::VectorXd by = matrix.colPivHouseholderQr().solve(off);
    for (std::size_t i = 0; i < found.size(); ++i) found[i] += by[static_cast<Eigen::Index>(i)];
  }
  if (!std::all_of(found.begin(), found.end(), [](double x) { return std::isfinite(x); }))
    return false;
  std::copy(found.begin(), found.end(), q.begin());
  return true;
}

}  // namespace robocell::internal
