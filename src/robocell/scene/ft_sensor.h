// FtSensor: a robot's force-torque sensor in a compiled model: the engine's pair of sensors, read
// as one wrench. It is resolved once and immutable; Read() is a function of model and data, so that
// it works on any data of the model. Robot (robot/robot.h) provides them by name.
//
// The reading is the load on the sensor: the wrench that the bodies beyond it exert on it. A mass m
// that hangs from it at rest reads m * g along gravity. (The engine's own sensors give the reaction
// to that.) Force and torque have the axes of `frame_site`, the torque is about its origin.
// "Beyond" is the subtree of the site's body, including that body: give it a negligible mass.
//
// Read() does not allocate. After a step the reading is that of the instant before it, with the
// controls that acted in the step, like all sensors of the engine.
#pragma once

#include <string>

#include "robocell/math/twist.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

class FtSensor {
 public:
  // Throws NotFoundError with the missing name and the available ones, and ArgumentError for
  // sensors that are not such a pair.
  FtSensor(const mjModel* model, const RobotRecord& robot, const ForceTorqueSensorSpec& spec);

  const std::string& name() const { return name_; }
  // Returns the full name of the site of the reading; "" without one.
  const std::string& frame_site() const { return frame_site_; }

  // `data` is in the state after a step or Forward().
  Wrench Read(const mjModel* model, const mjData* data) const;
  Pose frame_in_world(const mjData* data) const;

 private:
  Wrench ToolWeight(const mjModel* model, const mjData* data) const;

  std::string name_, frame_site_;
  int force_address_, torque_address_;
  int site_, frame_, body_;  // the site of measurement, that of the reading, the body of the site
  bool compensate_tool_;
};

}  // namespace robocell::internal
