#include "robocell/expert/guided_arm.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/motion/timed_path.h"
#include "robocell/robot/arrival.h"

namespace robocell {
namespace {

constexpr double kSettleSeconds = 0.1;      // after a motion ...
constexpr double kMostSettleSeconds = 0.5;  // ... and while the arm is still on its way
// The arm is near enough for the next motion, which can begin from anywhere near: within this many
// tolerances, and at least within these distances, rad and m.
constexpr double kNearlyArrived = 2, kNearRad = 0.02, kNearMetres = 0.002;
constexpr double kMostLag = 0.25;       // rad between target and joint: the arm is blocked
constexpr double kMostSlideLag = 0.08;  // ... in metres
constexpr double kLagSeconds = 0.2;

bool IsSlide(const Robot& robot, size_t joint) {
  return robot.chain().joints()[joint].type == ChainJointType::kSlide;
}

}  // namespace

GuidedArm::GuidedArm(const Robot& robot, double tick)
    : robot_(robot),
      tick_(tick),
      target_(robot_.controller(robot_.arm().name()).commanded_joint_pos()),
      path_(target_, tick),
      arrival_tolerances_(internal::ArrivalTolerances(robot_, robot_.arm().name())) {
  for (size_t i = 0; i < arrival_tolerances_.size(); ++i) {
    arrival_tolerances_[i] = std::max(kNearlyArrived * arrival_tolerances_[i],
                                      IsSlide(robot_, i) ? kNearMetres : kNearRad);
  }
}

void GuidedArm::Begin() {
  path_ = TimedPath(target_, tick_);
  waited_ = 0;
}

void GuidedArm::AddLeg(JointPath points, double speed, double least) {
  path_.AddLeg(std::move(points), speed, least);
}

void GuidedArm::TakeMeasured() {
  target_ = JointVector(std::span<const double>(robot_.arm().joint_pos()));
}

const JointVector& GuidedArm::Next() { return target_ = path_.Next(); }

bool GuidedArm::Settled() {
  if (!path_.finished()) return false;
  ++waited_;
  if (waited_ <= Ticks(kSettleSeconds)) return false;
  return Arrived() || waited_ > Ticks(kMostSettleSeconds);
}

bool GuidedArm::Blocked() {
  lagging_ = Lag() > 1 ? lagging_ + 1 : 0;
  return lagging_ > Ticks(kLagSeconds);
}

int GuidedArm::Ticks(double seconds) const {
  return static_cast<int>(std::ceil(seconds / tick_ - 1e-9));
}

double GuidedArm::GentleSeconds(const JointPath& points, double least, double most) const {
  const std::vector<double> jumps = ServoJumps(robot_.scene().model(), robot_.arm());
  return std::clamp(SecondsForJumps(points, jumps, tick_), least, most);
}

// Returns how far the worst joint is behind its target, as a share of the lag that counts as
// blocked.
double GuidedArm::Lag() const {
  const std::vector<double> q = robot_.arm().joint_pos();
  double lag = 0;
  for (int i = 0; i < target_.size(); ++i) {
    const double most = IsSlide(robot_, static_cast<size_t>(i)) ? kMostSlideLag : kMostLag;
    lag = std::max(lag, std::abs(q[i] - target_[i]) / most);
  }
  return lag;
}

bool GuidedArm::Arrived() const {
  return internal::AreWithin(robot_.arm().joint_pos(), target_, arrival_tolerances_);
}

}  // namespace robocell
