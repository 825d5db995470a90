#include "robocell/expert/arm_pair.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "robocell/motion/timed_path.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {

ArmPair::ArmPair(const Scene& scene, const std::array<std::string, 2>& arms, double tick)
    : robots_{Robot::Of(scene, arms[0]), Robot::Of(scene, arms[1])},
      tick_(tick),
      guided_{GuidedArm(robots_[0], tick), GuidedArm(robots_[1], tick)} {
  for (size_t i = 0; i < 2; ++i) {
    const GripperGroup& gripper = robots_[i].gripper();
    openings_[i] = wanted_[i] =
        std::clamp(robots_[i].controller(gripper.name()).target()[0], 0.0, 1.0);
  }
}

std::vector<double> ArmPair::Joined(const JointVector& first, const JointVector& second) const {
  std::vector<double> both(first.begin(), first.end());
  both.insert(both.end(), second.begin(), second.end());
  return both;
}

std::vector<double> ArmPair::target() const {
  return Joined(guided_[0].target(), guided_[1].target());
}

JointVector ArmPair::Part(const std::vector<double>& both, size_t i) const {
  const auto first = static_cast<size_t>(guided_[0].target().size());
  const std::span<const double> all(both);
  return JointVector(i == 0 ? all.first(first) : all.subspan(first));
}

std::string LastLinkOf(const Robot& robot) {
  const mjModel* m = robot.scene().model();
  const int joint = FindId(m, mjOBJ_JOINT, robot.joint_names().back());
  return ElementName(m, mjOBJ_BODY, m->jnt_bodyid[joint]);
}

void ArmPair::Follow(PairPath path, double speed, double least) {
  path_ = {target()};
  lengths_ = {0};
  for (std::vector<double>& point : path) {
    double step = 0;
    for (size_t j = 0; j < point.size(); ++j)
      step = std::max(step, std::abs(point[j] - path_.back()[j]));
    if (step <= 0) continue;
    lengths_.push_back(lengths_.back() + step);
    path_.push_back(std::move(point));
  }
  ticks_ = Ticks(std::max(least, TimedPath::kPeakSpeed * lengths_.back() / speed));
  at_ = 0;
  for (GuidedArm& guided : guided_) guided.Begin();
}

void ArmPair::FollowGently(const PairPath& path, double speed, double least, double most) {
  double seconds = least;
  for (size_t i = 0; i < 2; ++i) {
    JointPath points = {guided_[i].target()};
    for (const std::vector<double>& point : path) points.push_back(Part(point, i));
    seconds = std::max(seconds, guided_[i].GentleSeconds(points, least, most));
  }
  Follow(path, speed, seconds);
}

bool ArmPair::Settled() {
  if (!finished()) return false;
  const bool first = guided_[0].Settled(), second = guided_[1].Settled();
  return first && second;
}

bool ArmPair::Blocked() {
  const bool first = guided_[0].Blocked(), second = guided_[1].Blocked();
  return first || second;
}

void ArmPair::SetOpening(size_t i, double opening, double speed) {
  wanted_[i] = opening;
  steps_[i] = speed * tick_;
}

void ArmPair::Next() {
  for (size_t i = 0; i < 2; ++i)
    openings_[i] += std::clamp(wanted_[i] - openings_[i], -steps_[i], steps_[i]);
  if (finished()) return;
  ++at_;
  const double t = static_cast<double>(at_) / ticks_;
  const double share = t * t * t * (10 - 15 * t + 6 * t * t);  // from rest to rest
  const double length = share * lengths_.back();
  const auto next = std::ranges::upper_bound(lengths_, length);
  const size_t to = std::min(static_cast<size_t>(next - lengths_.begin()), path_.size() - 1);
  const size_t from = to == 0 ? 0 : to - 1;
  const double span = lengths_[to] - lengths_[from];
  const double part = span > 0 ? std::clamp((length - lengths_[from]) / span, 0.0, 1.0) : 1;
  std::vector<double> both = path_[from];
  for (size_t j = 0; j < both.size(); ++j) both[j] += part * (path_[to][j] - both[j]);
  if (finished()) both = path_.back();
  for (size_t i = 0; i < 2; ++i) guided_[i].SetTarget(Part(both, i));
}

Action ArmPair::Command() const {
  RobotAction action;
  for (size_t i = 0; i < 2; ++i) {
    const JointVector& target = guided_[i].target();
    action[robots_[i].arm().name()] =
        GroupCommand::Joints(std::vector<double>(target.begin(), target.end()));
    action[robots_[i].gripper().name()] = GroupCommand::Opening(openings_[i]);
  }
  return {{robots_[0].name(), std::move(action)}};
}

}  // namespace robocell::internal
