#include "robocell/viewer/trace_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <string>
#include <Eigen/Core>

#include "robocell/base/error.h"

namespace robocell {
namespace {

constexpr double kStill = 1e-4;  // metres

}  // namespace

void TraceLines::AddSegment(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                            const std::array<float, 4>& rgba) {
  const bool seen = std::all_of(rgba.begin(), rgba.end(), [](float x) { return std::isfinite(x); });
  if (!from.allFinite() || !to.allFinite() || !seen) {
    throw ArgumentError(fmt::format(
        "viewer: the ends and the colour of a segment must be finite, got ({}, {}, {}), "
        "({}, {}, {}) and rgba ({}, {}, {}, {})",
        from.x(), from.y(), from.z(), to.x(), to.y(), to.z(), rgba[0], rgba[1], rgba[2], rgba[3]));
  }
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

void TraceLines::set_length(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0) {
    throw ArgumentError(fmt::format(
        "viewer: the length of traces is a number of seconds, 0 for no limit, got {}", seconds));
  }
  length_ = seconds;
}

void TraceLines::Clear() {
  paths_.clear();
  segments_.clear();
}

}  // namespace robocell
