// HandGeometry: the colliding geoms of a robot's hand, and of the link that carries it, relative to
// the TCP while the fingers close; and their clearance from other geoms. The arm plays no part: the
// hand is placed anywhere by the pose of its TCP.
//
//   HandGeometry hand(robot, shape);
//   hand.IsFree({.tcp_in_world = tcp, .gap = 0.05, .clearance = 0.002}, object_geoms);
//
// It has its own copy of the scene's state, in which other geoms stay as of the last Update(). One
// thread at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/owners.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {

struct HandPlace {
  Pose tcp_in_world;
  double gap = 0;        // m between the fingers
  double clearance = 0;  // least distance, m
};

// Where a finger stops that closes until it touches.
struct FingerStop {
  bool touches = false;
  double gap = 0;                                    // of the hand, if all fingers stopped there
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // from the object to the finger
};

class HandGeometry {
 public:
  HandGeometry(const Robot& robot, std::shared_ptr<const GripperShape> shape);

  // Copies the scene's present state.
  void Update();
  // Puts these geoms where they are relative to `frame`, as if that were the world's, until Update().
  void PlaceIn(const Pose& frame, const std::vector<int>& others);
  // Returns a text that identifies the hand's shape: its geoms at all gaps.
  std::string Description() const;

  const GripperShape& shape() const { return *shape_; }
  const mjModel* model() const { return model_; }
  const mjData* data() const { return data_.get(); }  // others as of the last Update()
  const std::vector<int>& geoms() const { return geoms_; }
  // Returns true for each geom of the robot.
  const std::vector<char>& is_robot() const { return is_robot_; }

  // Returns true if no geom of the hand is nearer to one of the others than the clearance, by the
  // engine's distances.
  bool IsFree(const HandPlace& place, const std::vector<int>& others);
  // Returns the geom that was too near when IsFree last returned false, of the others.
  int obstacle() const { return obstacle_; }

  // Returns the smallest extent of a geom of the hand along an axis of its own, m.
  double thinnest() const { return thinnest_; }
  // Returns the number of fingers that close; 0 for a hand without any.
  int finger_count() const { return finger_count_; }
  // Closes each finger from a gap on, until it touches one of the others or is closed.
  std::vector<FingerStop> Close(const Pose& tcp_in_world, double gap,
                                const std::vector<int>& others);

  // Returns points on the hand's surface in the TCP's frame, one in each column, spread evenly.
  Eigen::Matrix3Xd SurfacePoints(double gap, int count) const;

 private:
  void FindFingers();
  void PlaceGeoms(const Pose& tcp_in_world, double gap) const;
  // Returns the smallest distance of a finger to the others at a row of the shape, and its direction.
  double FingerDistance(int finger, size_t row, const Pose& tcp_in_world,
                        const std::vector<int>& others, Eigen::Vector3d* normal);

  Robot robot_;
  std::shared_ptr<const GripperShape> shape_;
  const mjModel* model_;
  DataPtr data_;
  std::vector<int> geoms_;
  std::vector<char> is_robot_;
  std::vector<std::vector<Pose>> in_tcp_;  // per row of the shape, per geom
  std::vector<int> finger_of_;  // per geom of geoms_: index of its finger, -1 for the palm
  int finger_count_ = 0;
  double thinnest_ = 0;
  int obstacle_ = -1;
};

}  // namespace robocell::internal
