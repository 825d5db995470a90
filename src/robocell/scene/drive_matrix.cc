#include "robocell/scene/drive_matrix.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <Eigen/QR>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/control_modes.h"

namespace robocell::internal {
namespace {

// Columns count as independent above this share of the largest.
constexpr double kIndependent = 1e-6;

// Returns a joint's value as a polynomial of one of the degrees of freedom.
std::optional<LengthTerm> TermOf(int joint, double coefficient, std::span<const int> joints,
                                 std::span<const JointFollower> followers) {
  const auto at = std::find(joints.begin(), joints.end(), joint);
  if (at != joints.end())
    return LengthTerm{static_cast<std::size_t>(at - joints.begin()), coefficient, {}};
  for (const JointFollower& f : followers) {
    if (f.joint == joint) return LengthTerm{f.leader, coefficient, f.of_leader};
  }
  return std::nullopt;
}

std::vector<double> ReferenceOf(const mjModel* m, std::span<const int> joints) {
  std::vector<double> q;
  for (const int joint : joints) q.push_back(m->qpos0[m->jnt_qposadr[joint]]);
  return q;
}

int RankOf(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return 0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(matrix);
  factors.setThreshold(kIndependent);
  return static_cast<int>(factors.rank());
}

// Returns true for `<joint>_torque` and `<joint>_velocity`.
bool IsOfAMode(const mjModel* m, int actuator) {
  if (!ActsOnJoint(m, actuator)) return false;
  const std::string joint = ElementName(m, mjOBJ_JOINT, m->actuator_trnid[2 * actuator]);
  const std::string name = ElementName(m, mjOBJ_ACTUATOR, actuator);
  return name == ModeActuatorName(joint, CtrlMode::kTorque) ||
         name == ModeActuatorName(joint, CtrlMode::kVelocity);
}

std::string TextOf(const Eigen::MatrixXd& matrix) {
  std::vector<std::string> rows;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    std::vector<std::string> row;
    for (Eigen::Index c = 0; c < matrix.cols(); ++c)
      row.push_back(fmt::format("{:g}", matrix(r, c)));
    rows.push_back(fmt::format("[{}]", fmt::join(row, ", ")));
  }
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

}  // namespace

std::optional<DriveLength> LengthOver(const mjModel* m, int actuator, std::span<const int> joints,
                                      std::span<const JointFollower> followers) {
  DriveLength length;
  const double gear = Gear(m, actuator);
  const int target = m->actuator_trnid[2 * actuator];
  if (ActsOnJoint(m, actuator)) {
    const auto term = TermOf(target, gear, joints, followers);
    if (!term) return std::nullopt;
    length.push_back(*term);
    return length;
  }
  if (m->actuator_trntype[actuator] != mjTRN_TENDON) return std::nullopt;
  for (int w = m->tendon_adr[target]; w < m->tendon_adr[target] + m->tendon_num[target]; ++w) {
    if (m->wrap_type[w] != mjWRAP_JOINT) return std::nullopt;  // spatial
    const auto term = TermOf(m->wrap_objid[w], gear * m->wrap_prm[w], joints, followers);
    if (!term) return std::nullopt;
    length.push_back(*term);
  }
  return length;
}

Eigen::MatrixXd DriveMatrix(std::span<const DriveLength> lengths, std::span<const double> q) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(lengths.size()),
                                                 static_cast<Eigen::Index>(q.size()));
  for (std::size_t a = 0; a < lengths.size(); ++a) {
    for (const LengthTerm& term : lengths[a]) {
      matrix(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(term.joint)) +=
          term.coefficient * term.of_joint.slope(q[term.joint]);
    }
  }
  return matrix;
}

std::vector<int> FindMatrixDrive(const mjModel* m, std::span<const int> joints) {
  const std::vector<JointFollower> followers = FollowersOf(m, joints);
  for (const CtrlMode kind : {CtrlMode::kPosition, CtrlMode::kVelocity, CtrlMode::kTorque}) {
    std::vector<int> actuators;
    std::vector<DriveLength> lengths;
    for (std::size_t joint = 0; joint < joints.size(); ++joint) {
      for (int a = 0; a < m->nactuator; ++a) {
        if (ActuatorKind(m, a) != kind || IsOfAMode(m, a)) continue;
        const auto length = LengthOver(m, a, joints, followers);
        if (!length || length->empty()) continue;
        const auto first = std::min_element(
            length->begin(), length->end(),
            [](const LengthTerm& x, const LengthTerm& y) { return x.joint < y.joint; });
        if (first->joint != joint) continue;
        actuators.push_back(a);
        lengths.push_back(*length);
      }
    }
    const std::vector<double> q = ReferenceOf(m, joints);
    if (RankOf(DriveMatrix(lengths, q)) == static_cast<int>(joints.size())) return actuators;
  }
  return {};
}

std::string WhyNoMatrixDrive(const mjModel* m, std::span<const int> joints,
                             std::span<const int> actuators) {
  const std::vector<JointFollower> followers = FollowersOf(m, joints);
  std::vector<DriveLength> lengths;
  for (const int a : actuators) {
    auto length = LengthOver(m, a, joints, followers);
    if (!length) {
      return fmt::format(
          "actuator '{}' acts on more than the arm's joints, or not through joints "
          "and fixed tendons alone",
          ElementName(m, mjOBJ_ACTUATOR, a));
    }
    lengths.push_back(std::move(*length));
  }
  const Eigen::MatrixXd matrix = DriveMatrix(lengths, ReferenceOf(m, joints));
  const int rank = RankOf(matrix);
  if (rank == static_cast<int>(joints.size())) return "";
  return fmt::format("its actuators move {} of {}: the matrix of their lengths is {}", rank,
                     Counted(static_cast<int64_t>(joints.size()), "joint"), TextOf(matrix));
}

}  // namespace robocell::internal
