// PlanarMotion: what bases that move over the floor have in common (base_group.cc, wheeled_base.h).
// They have three joint values, in an order of their own, whatever moves them.
//
//   const PlanarMotion* motion = PlanarMotion::Of(robot.base());   // null for other bases
//   robot.Apply({{robot.base().name(), GroupCommand::Joints(motion->JointsAt(pose, now))}});
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/robot/move_group.h"

namespace robocell::internal {

class PlanarMotion {
 public:
  // Returns null for a base that does not move in a plane.
  static const PlanarMotion* Of(const BaseGroup& base) {
    return dynamic_cast<const PlanarMotion*>(&base);
  }

  // Returns the joint values at which the base stands at a pose; the turn is the one nearest to that
  // of `near`, joint values too. Throws ArgumentError for a pose outside of its plane, or beyond the
  // range of its joints.
  virtual std::vector<double> JointsAt(const Pose& base_in_world,
                                       std::span<const double> near) const = 0;
  // Returns the frame, in that of the base, whose origin stays in place while the base turns, and
  // whose x axis points ahead.
  virtual Pose drive_frame() const { return Pose(); }
  virtual bool drives_sideways() const { return true; }
  // Returns the largest speeds of the base.
  virtual BaseSpeeds most_speeds() const {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    return {.linear = kAny, .angular = kAny};
  }

 protected:
  ~PlanarMotion() = default;
};

}  // namespace robocell::internal
