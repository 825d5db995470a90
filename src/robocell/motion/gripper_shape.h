// GripperShape: the shape of a parallel gripper while it closes, measured once per robot by closing
// it without an object in a separate scene: positions of the pads, reach of the fingertips, finger
// joints at each gap. Linkages swing: pads move along the approach direction too, and need not be
// at the TCP at all.
//
//   std::shared_ptr<const GripperShape> shape = GripperShape::Of(config, run.options, timestep);
//   Eigen::Vector3d between_the_pads = shape->PadAt(0.04);   // in the grasp frame
//
// The grasp frame is at the TCP: y is the direction in which the fingers close, z the approach
// (from the wrist to the pads), x = y cross z. Lengths are in metres. Values between measured gaps
// are interpolated, those outside are clamped.
//
// A suction gripper (robot/suction_gripper.h) has one row with the gap 0. Its pad is the middle of
// the face that sticks, whose half sizes along x and y are pad_half_width and pad_half_height; y is
// an axis of the TCP.
//
// A pure function of the configuration and the options, cached in the process. Throws NotFoundError
// without arm or gripper, ArgumentError for a gripper of a custom kind, DivergedError for one that
// is unstable at this timestep. Any thread may call Of.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/math/pose.h"
#include "robocell/robot/move_group.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/sim_options.h"

namespace robocell {

class GripperShape {
 public:
  // The gripper at one moment of closing.
  struct Row {
    double gap = 0;                                 // free distance between the fingers
    std::vector<double> joints;                     // joint_names()
    Eigen::Vector3d pad = Eigen::Vector3d::Zero();  // the centre between the pads, grasp frame
    double across = 0;  // distance of the pads' centres along y; of a jaw that swings it grows less
                        // than the gap
    double tip = 0;     // the hand's farthest point along the approach, including visual parts
  };

  static std::shared_ptr<const GripperShape> Of(const RobotConfig& config,
                                                const SimOptions& options, double timestep);

  // Returns true if a gripper can be measured: fingers moved by actuators, or suction cups.
  static bool Supports(const GripperGroup& gripper);

  // Returns all joints of the hand, including the linkage, without the robot's prefix.
  const std::vector<std::string>& joint_names() const { return joint_names_; }
  const Pose& grasp_in_tcp() const { return grasp_in_tcp_; }
  bool is_suction() const { return is_suction_; }
  double closed_gap() const { return rows_.front().gap; }
  double open_gap() const { return rows_.back().gap; }
  double pad_half_height() const { return pad_half_height_; }  // along the approach
  double pad_half_width() const { return pad_half_width_; }    // along x
  const std::vector<Row>& rows() const { return rows_; }       // rows by increasing gap

  void JointsAt(double gap, std::span<double> out) const;
  Eigen::Vector3d PadAt(double gap) const;
  double AcrossAt(double gap) const;
  // Returns the farthest tip on the way from open to this gap.
  double TipAt(double gap) const;

 private:
  friend class GripperSweep;
  friend class CupSurvey;
  struct Place {
    size_t below = 0;
    double part = 0;  // share of the interval to the next row
  };
  Place Find(double gap) const;

  std::vector<std::string> joint_names_;
  Pose grasp_in_tcp_;
  bool is_suction_ = false;
  double pad_half_height_ = 0, pad_half_width_ = 0;
  std::vector<Row> rows_;
};

}  // namespace robocell
