// TcpHandle: a marker at a robot's TCP that the mouse drags; inverse kinematics follows. Internal
// to viewer/.
//
// Dragging the middle moves the TCP in the plane of the picture, dragging an arrow along it; with
// Shift it turns instead. A target that the arm cannot reach moves nothing.
#pragma once

#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/render/markers.h"
#include "robocell/robot/robot.h"
#include "robocell/viewer/scene_view.h"

namespace robocell::internal {

class TcpHandle {
 public:
  // Throws NotFoundError for a robot without an arm.
  TcpHandle(const Robot& robot, bool commands);

  // Lies at the TCP while nobody drags it.
  void Follow();
  void AddMarkers(std::vector<Marker>& markers) const;
  // Takes hold of it, if it is seen at this place of the picture (scene_view.h).
  bool Grab(const SceneView& view, const Eigen::Vector2d& place, double aspect);
  // Moves the target to this place, or turns it by dx and dy heights of the picture.
  void Drag(const SceneView& view, const Eigen::Vector2d& place, bool turns, double dx, double dy);
  void Let() { part_ = kNone; }
  bool grabbed() const { return part_ != kNone; }
  // Returns why the last target moved nothing; "" if it did.
  const std::string& problem() const { return problem_; }

 private:
  enum Part { kNone = -2, kMiddle = -1, kX = 0, kY = 1, kZ = 2 };
  Eigen::Vector3d Tip(int axis) const;
  void MoveRobot();

  Robot robot_;
  bool commands_;
  double length_;
  Pose target_;  // in the world
  int part_ = kNone;
  std::string problem_;
};

}  // namespace robocell::internal
