#include "robocell/viewer/trace_lines.h"

namespace robocell {
namespace {

constexpr double kStill = 1e-4;  // metres

}  // namespace

void TraceLines::AddSegment(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                            const std::array<float, 4>& rgba) {
  segments_.push_back({from, to, rgba});
  if (segments_.size() > kMostSegments) segments_.pop_front();
}

void TraceLines::Extend(const std::string& point, double time, const Eigen::Vector3d& position) {
  std::deque<Point>& path = paths_[point];
  if (!path.empty() && time < path.back().time) path.clear();
  const bool moved = path.empty() || (position - path.back().position).norm() > kStill;
  if (moved && position.allFinite()) path.push_back({time, position});
  while (path.size() > kMostSegments ||
         (length_ > 0 && path.size() > 1 && path[1].time < time - length_))
    path.pop_front();
  if (length_ > 0 && path.size() == 1 && path.front().time < time - length_) {
    path.front() = {time, path.front().position};  // it rests there
  }
}

void TraceLines::Clear() {
  paths_.clear();
  segments_.clear();
}

}  // namespace robocell
