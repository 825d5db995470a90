#include "robocell/robot/arm_group.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/robot/joint_resistance.h"

namespace robocell {
namespace {

constexpr double kRounding = 1e-3;  // rad or m, of joint limits
constexpr double kInside = 0.999;   // of a force limit, so that it does not clip
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
  const mjModel* m = core().model();
  const std::vector<int>& ids = core().actuator_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    const double gear = internal::Gear(m, ids[i]);
    const mjtNum* bias = m->actuator_biasprm + mjNBIAS * ids[i];
    out[i] = q[i] + (bias[2] * v[i] - torque[i] / (gear * gear)) / bias[1];
  }
}

}  // namespace robocell
