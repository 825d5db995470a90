// TraceLines: lines in the world that a viewer draws: the paths of moving points, and segments of a
// program's own. Bounded: the oldest parts go first.
//
//   TraceLines traces;
//   traces.set_length(5);                                   // seconds; 0: no limit
//   traces.Extend("robot: TCP", scene.time(), tcp.translation());
//   traces.AddSegment(a, b, {1, 0.5f, 0.1f, 1});
//
// Throws ArgumentError for numbers that are not finite.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <Eigen/Core>

namespace robocell {

struct TraceSegment {
  Eigen::Vector3d from, to;  // in the world
  std::array<float, 4> rgba;
};

class TraceLines {
 public:
  static constexpr size_t kMostSegments = 8192;  // of a program, and of each path
  static constexpr std::array<float, 4> kColour = {1.0f, 0.55f, 0.1f, 1};

  void AddSegment(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                  const std::array<float, 4>& rgba = kColour);
  // Continues the path of a point. A step back in time begins the path anew; a point that has
  // hardly moved adds nothing.
  void Extend(const std::string& point, double time, const Eigen::Vector3d& position);
  // Forgets the path of a point.
  void Drop(const std::string& point) { paths_.erase(point); }
  // Forgets everything.
  void Clear();

  double length() const { return length_; }
  // Seconds of simulation that a path covers; 0: all of it, within kMostSegments.
  // Throws ArgumentError for a negative number too.
  void set_length(double seconds);

  struct Point {
    double time;
    Eigen::Vector3d position;
  };
  const std::map<std::string, std::deque<Point>>& paths() const { return paths_; }
  const std::deque<TraceSegment>& segments() const { return segments_; }

 private:
  double length_ = 5;
  std::map<std::string, std::deque<Point>> paths_;
  std::deque<TraceSegment> segments_;
};

}  // namespace robocell
