#include "robocell/motion/timed_path.h"

#include <algorithm>
#include <cmath>

namespace robocell {
namespace {

double Quintic(double t) { return t * t * t * (10 + t * (-15 + 6 * t)); }

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

}  // namespace robocell
