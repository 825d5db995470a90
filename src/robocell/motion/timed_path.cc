#include "robocell/motion/timed_path.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/actuator_kind.h"

namespace robocell {
namespace {

double Quintic(double t) { return t * t * t * (10 + t * (-15 + 6 * t)); }

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr double kProbe = 1e-3;  // rad or m: control values are linear in joint positions

double LargestForce(const mjModel* m, int actuator, int joint) {
  double most = kNoLimit;
  if (m->actuator_forcelimited[actuator]) {
    const double* range = m->actuator_forcerange + 2 * actuator;
    most = std::min(std::abs(range[0]), std::abs(range[1]));
  }
  if (m->jnt_actfrclimited[joint]) {
    const double* range = m->jnt_actfrcrange + 2 * joint;
    const double gear = std::abs(internal::Gear(m, actuator));
    most = std::min({most, std::abs(range[0]) / gear, std::abs(range[1]) / gear});
  }
  return most;
}

bool AreServos(const mjModel* m, const std::vector<std::string>& actuators) {
  return std::all_of(actuators.begin(), actuators.end(), [&](const std::string& name) {
    const int id = FindId(m, mjOBJ_ACTUATOR, name);
    return id < 0 || internal::IsPositionServo(m, id);
  });
}

}  // namespace

void TimedPath::AddLeg(JointPath points, double speed, double least) {
  const double seconds = std::max(least, kPeakSpeed * JointDistance(end_, points.back()) / speed);
  points.insert(points.begin(), end_);
  end_ = points.back();
  legs_.push_back(
      {std::move(points), std::max(1, static_cast<int>(std::ceil(seconds / tick_ - 1e-9)))});
}

JointVector TimedPath::Next() {
  if (finished()) return end_;
  const Leg& leg = legs_[leg_];
  ++done_;
  const size_t parts = leg.points.size() - 1;
  const double s = Quintic(static_cast<double>(done_) / leg.ticks) * static_cast<double>(parts);
  const size_t part = std::min(static_cast<size_t>(s), parts - 1);
  const JointVector q =
      Blend(leg.points[part], leg.points[part + 1], s - static_cast<double>(part));
  if (done_ < leg.ticks) return q;
  ++leg_;
  done_ = 0;
  return leg.points.back();
}

int TimedPath::remaining() const {
  int ticks = -done_;
  for (size_t i = leg_; i < legs_.size(); ++i) ticks += legs_[i].ticks;
  return std::max(0, ticks);
}

std::vector<double> ServoJumps(const mjModel* m, const MoveGroup& arm) {
  const std::vector<std::string>& joints = arm.joint_names();
  const std::vector<std::string>& actuators = arm.actuator_names();
  std::vector<double> q = arm.joint_pos(), here(actuators.size()), there(actuators.size());
  std::vector<double> jumps(joints.size(), kNoLimit);
  if (!AreServos(m, actuators)) return jumps;  // the force of motors is their controller's
  arm.CtrlForJointPos(q, here);
  for (double& value : q) value += kProbe;
  arm.CtrlForJointPos(q, there);
  for (size_t a = 0; a < actuators.size(); ++a) {
    const int actuator = FindId(m, mjOBJ_ACTUATOR, actuators[a]);
    if (actuator < 0 || !internal::ActsOnJoint(m, actuator)) continue;
    const int joint = m->actuator_trnid[2 * actuator];
    const auto at = std::find(joints.begin(), joints.end(), ElementName(m, mjOBJ_JOINT, joint));
    const double force_per_jump =
        std::abs(m->actuator_gainprm[mjNGAIN * actuator]) * std::abs(there[a] - here[a]) / kProbe;
    if (at == joints.end() || force_per_jump == 0) continue;
    jumps[at - joints.begin()] = LargestForce(m, actuator, joint) / force_per_jump;
  }
  return jumps;
}

double SecondsForJumps(const JointPath& points, const std::vector<double>& jumps, double tick) {
  const double parts = static_cast<double>(points.size()) - 1;
  double ticks = 0;
  for (size_t k = 1; k < points.size(); ++k) {
    for (int i = 0; i < points[k].size(); ++i) {
      const double jump = std::abs(points[k][i] - points[k - 1][i]);
      ticks = std::max(ticks, TimedPath::kPeakSpeed * parts * jump / jumps[i]);
    }
  }
  return ticks * tick;
}

}  // namespace robocell
