// FtSensor: a robot's force-torque sensor in a compiled model: the engine's pair of sensors, read
// as one wrench. Resolved once and immutable; Read() is a function of model and data, so that it
// works on any data of the model. Robot (robot/robot.h) has them by name.
//
// The reading is the load on the sensor: what the bodies beyond it exert on it. A mass m that hangs
// from it at rest reads m * g along gravity. (The engine's own sensors give the reaction to that.)
// Force and torque have the axes of `frame_site`, the torque is about its origin. "Beyond" is the
// subtree of the body that the site is on, that body included: let it weigh next to nothing.
//
// No allocation in Read(). After a step the reading is that of the instant before it, with the
// controls that acted in it, as are all sensors of the engine.
#pragma once

#include <string>

#include "robocell/math/twist.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

class FtSensor {
 public:
  // NotFoundError contains the missing name and the available ones; ArgumentError is raised for
  // sensors that are not such a pair.
  FtSensor(const mjModel* model, const RobotRecord& robot, const ForceTorqueSensorSpec& spec);

  const std::string& name() const { return name_; }
  // Full name of the site of the reading; "" when it has none.
  const std::string& frame_site() const { return frame_site_; }

  // `data` as a step or Forward() left it.
  Wrench Read(const mjModel* model, const mjData* data) const;
  Pose frame_in_world(const mjData* data) const;

 private:
  Wrench ToolWeight(const mjModel* model, const mjData* data) const;

  std::string name_, frame_site_;
  int force_address_, torque_address_;
  int site_, frame_, body_;  // where it measures, where it is read, whose site it is
  bool compensate_tool_;
};

}  // namespace robocell::internal
