#include "robocell/robot/arm_group.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <Eigen/Cholesky>

#include "robocell/base/error.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/robot/joint_resistance.h"

namespace robocell {
namespace {

constexpr double kRounding = 1e-3;  // rad or m, of joint limits
constexpr double kInside = 0.999;   // share of a force limit, so that it does not clip
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

inline void CutOff(Interval& limit, const mjtNum* range, double scale) {
  const double a = scale * range[0], b = scale * range[1];
  const double low = std::min(a, b), high = std::max(a, b);
  limit = {std::clamp(limit.lower, low, high), std::clamp(limit.upper, low, high)};
}

// Returns false at an end of the range too.
inline bool IsInside(double x, const mjtNum* range, double scale) {
  const double a = scale * range[0], b = scale * range[1];
  return (a < x && x < b) || (b < x && x < a);
}

}  // namespace

const Chain& ArmGroup::chain() const {
  if (has_chain()) return **chain_;
  throw NotFoundError(place() + " has no chain, which its controller needs: kinematics need the " +
                      "configured arm of a robot");
}

std::optional<TaskSpaceConfig> ArmGroup::task_space() const {
  for (const RobotRecord& robot : core().scene().compiled()->robots()) {
    if (robot.name != core().names().robot) continue;
    const MoveGroupConfig* group = robot.config.move_groups.find(core().names().group);
    if (group && group->task_space) return *group->task_space;
  }
  return std::nullopt;
}

size_t ArmGroup::FindBeyondLimits(std::span<const double> q) const {
  core().Bind();
  const mjModel* m = core().model();
  for (size_t i = 0; i < q.size(); ++i) {
    const int joint = core().joint_ids()[i];
    const mjtNum* range = m->jnt_range + 2 * joint;
    if (!m->jnt_limited[joint]) continue;
    if (q[i] < range[0] - kRounding || q[i] > range[1] + kRounding) return i;
  }
  return q.size();
}

void ArmGroup::GravityTorques(std::span<const double> q, std::span<double> out) const {
  chain().GravityTorques(q, gravity_in_base(), out);
}

void ArmGroup::InverseDynamics(std::span<const double> q, std::span<const double> qd,
                               std::span<const double> qdd, std::span<double> out) const {
  chain().InverseDynamics(q, qd, qdd, gravity_in_base(), out);
}

void ArmGroup::AddResistance(std::span<const double> q, std::span<const double> velocity,
                             std::span<double> torque) const {
  core().Bind();
  internal::AddJointResistance(core().model(), core().joint_ids(), q, velocity, torque);
  for (const GroupCore::Follower& f : core().followers()) {
    const double slope = f.of_leader.slope(q[f.leader]), at = f.of_leader.at(q[f.leader]);
    const double speed = slope * velocity[f.leader];
    double own = 0;
    internal::AddJointResistance(core().model(), {f.joint}, {&at, 1}, {&speed, 1}, {&own, 1});
    torque[f.leader] += slope * own;
  }
}

Interval ArmGroup::torque_limit(size_t joint) const {
  core().Bind();
  return TorqueLimit(core().model(), joint);
}

size_t ArmGroup::FindStrained(std::span<const double> torque, size_t from) const {
  core().Bind();
  const mjModel* m = core().model();
  for (size_t i = from; i < torque.size(); ++i) {
    if (!IsInsideLimits(m, i, torque[i])) return i;
  }
  return torque.size();
}

// Tests against TorqueLimit without computing it. If the limits do not overlap, no torque is
// inside.
bool ArmGroup::IsInsideLimits(const mjModel* m, size_t joint, double torque) const {
  if (!core().has_plain_drive()) [[unlikely]] {
    const Interval limit = TorqueLimitOfMatrix(joint);
    return limit.lower < torque && torque < limit.upper;
  }
  const int actuator = core().actuator_ids()[joint], id = core().joint_ids()[joint];
  const int input = m->actuator_ctrladr[actuator];
  const double gear = internal::Gear(m, actuator);
  return (!m->actuator_ctrllimited[input] ||
          IsInside(torque, m->actuator_ctrlrange + 2 * input,
                   gear * m->actuator_gainprm[mjNGAIN * actuator])) &&
         (!m->actuator_forcelimited[actuator] ||
          IsInside(torque, m->actuator_forcerange + 2 * actuator, gear)) &&
         (!m->jnt_actfrclimited[id] || IsInside(torque, m->jnt_actfrcrange + 2 * id, 1)) &&
         std::isfinite(torque);
}

// The limits clip in the engine's order, even if they do not overlap.
Interval ArmGroup::TorqueLimit(const mjModel* m, size_t joint) const {
  if (!core().has_plain_drive()) return TorqueLimitOfMatrix(joint);
  const int actuator = core().actuator_ids()[joint];
  Interval limit{-kNoLimit, kNoLimit};
  const int input = m->actuator_ctrladr[actuator];
  const double gear = internal::Gear(m, actuator);
  if (m->actuator_ctrllimited[input])
    CutOff(limit, m->actuator_ctrlrange + 2 * input,
           gear * m->actuator_gainprm[mjNGAIN * actuator]);
  return WithinForceLimits(m, joint, limit);
}

Interval ArmGroup::WithinForceLimits(const mjModel* m, size_t joint, Interval limit) const {
  const int actuator = core().actuator_ids()[joint], id = core().joint_ids()[joint];
  const double gear = internal::Gear(m, actuator);
  if (m->actuator_forcelimited[actuator])
    CutOff(limit, m->actuator_forcerange + 2 * actuator, gear);
  if (m->jnt_actfrclimited[id]) CutOff(limit, m->jnt_actfrcrange + 2 * id, 1);
  return limit;
}

void ArmGroup::CtrlForJointTorque(std::span<const double> torque, std::span<double> ctrl) const {
  core().Bind();
  if (!core().has_plain_drive()) [[unlikely]]
    return CtrlForTorqueOfMatrix(torque, ctrl);
  const mjModel* m = core().model();
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    const double gear = internal::Gear(m, ids[i]);
    ctrl[i] = torque[i] / (gear * m->actuator_gainprm[mjNGAIN * ids[i]]);
  }
}

void ArmGroup::CtrlForJointVel(std::span<const double> velocity, std::span<const double> now,
                               std::span<const double> torque, std::span<double> ctrl) const {
  core().Bind();
  if (!core().has_plain_drive()) [[unlikely]]
    return CtrlForVelocityOfMatrix(velocity, torque, ctrl);
  const mjModel* m = core().model();
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    const double gear = internal::Gear(m, ids[i]);
    const double gain = gear * m->actuator_gainprm[mjNGAIN * ids[i]];
    const Interval limit = WithinForceLimits(m, i, {-kNoLimit, kNoLimit});
    const double push = std::clamp(gain * gear * (velocity[i] - now[i]) + torque[i],
                                   kInside * limit.lower, kInside * limit.upper);
    ctrl[i] = gear * now[i] + push / gain;
  }
}

void ArmGroup::JointPosForTorque(std::span<const double> q, std::span<const double> v,
                                 std::span<const double> torque, std::span<double> out) const {
  core().Bind();
  if (!core().has_plain_drive()) [[unlikely]]
    return PositionForTorqueOfMatrix(q, v, torque, out);
  const mjModel* m = core().model();
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    const double gear = internal::Gear(m, ids[i]);
    const mjtNum* bias = m->actuator_biasprm + mjNBIAS * ids[i];
    out[i] = q[i] + (bias[2] * v[i] - torque[i] / (gear * gear)) / bias[1];
  }
}

// With the matrix A of the slopes of the actuators' lengths, torques are A^T times the forces, and
// velocities of lengths A times those of the joints.

// Returns the least forces that apply torques.
Eigen::VectorXd ArmGroup::ForcesFor(std::span<const double> torque) const {
  JointVector q(nq());
  core().GetJointPos(q);
  const Eigen::MatrixXd a = core().DriveMatrix(q);
  const Eigen::Map<const Eigen::VectorXd> tau(torque.data(),
                                              static_cast<Eigen::Index>(torque.size()));
  return a * (a.transpose() * a).ldlt().solve(tau);
}

// Applies while the other joints need no torque.
Interval ArmGroup::TorqueLimitOfMatrix(size_t joint) const {
  const mjModel* m = core().model();
  JointVector one(nq());
  one[static_cast<int>(joint)] = 1;
  const Eigen::VectorXd forces = ForcesFor(one);
  Interval limit{-kNoLimit, kNoLimit};
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    const double part = forces[static_cast<Eigen::Index>(i)];
    if (std::abs(part) < 1e-9) continue;
    const int input = m->actuator_ctrladr[ids[i]];
    if (m->actuator_ctrllimited[input])
      CutOff(limit, m->actuator_ctrlrange + 2 * input,
             m->actuator_gainprm[mjNGAIN * ids[i]] / part);
    if (m->actuator_forcelimited[ids[i]])
      CutOff(limit, m->actuator_forcerange + 2 * ids[i], 1 / part);
  }
  const int id = core().joint_ids()[joint];
  if (m->jnt_actfrclimited[id]) CutOff(limit, m->jnt_actfrcrange + 2 * id, 1);
  return limit;
}

void ArmGroup::CtrlForTorqueOfMatrix(std::span<const double> torque, std::span<double> ctrl) const {
  const mjModel* m = core().model();
  const Eigen::VectorXd forces = ForcesFor(torque);
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i)
    ctrl[i] = forces[static_cast<Eigen::Index>(i)] / m->actuator_gainprm[mjNGAIN * ids[i]];
}

void ArmGroup::CtrlForVelocityOfMatrix(std::span<const double> velocity,
                                       std::span<const double> torque,
                                       std::span<double> ctrl) const {
  CtrlForTorqueOfMatrix(torque, ctrl);
  JointVector q(nq());
  core().GetJointPos(q);
  const Eigen::VectorXd speeds =
      core().DriveMatrix(q) * Eigen::Map<const Eigen::VectorXd>(
                                  velocity.data(), static_cast<Eigen::Index>(velocity.size()));
  for (size_t i = 0; i < ctrl.size(); ++i) ctrl[i] += speeds[static_cast<Eigen::Index>(i)];
}

// The servos' stiffness and damping, of lengths, are those of the joints between A^T and A.
void ArmGroup::PositionForTorqueOfMatrix(std::span<const double> q, std::span<const double> v,
                                         std::span<const double> torque,
                                         std::span<double> out) const {
  const mjModel* m = core().model();
  const std::vector<int>& ids = core().actuator_ids();
  const Eigen::MatrixXd a = core().DriveMatrix(q);
  Eigen::VectorXd stiffness(a.rows()), damping(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const mjtNum* bias = m->actuator_biasprm + mjNBIAS * ids[static_cast<size_t>(i)];
    stiffness[i] = -bias[1];
    damping[i] = -bias[2];
  }
  const auto n = static_cast<Eigen::Index>(torque.size());
  const Eigen::VectorXd braking =
      a.transpose() * damping.asDiagonal() * a * Eigen::Map<const Eigen::VectorXd>(v.data(), n);
  const Eigen::MatrixXd of_joints = a.transpose() * stiffness.asDiagonal() * a;
  const Eigen::VectorXd ahead =
      of_joints.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(torque.data(), n) + braking);
  for (Eigen::Index i = 0; i < n; ++i)
    out[static_cast<size_t>(i)] = q[static_cast<size_t>(i)] + ahead[i];
}

}  // namespace robocell
